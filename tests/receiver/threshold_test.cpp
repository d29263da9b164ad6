// The study of loss: what a narrow, aided loop gains.
#include "schuler/receiver/threshold.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

namespace schuler::receiver {
namespace {

TEST(Threshold, ANarrowAidedLoopHoldsLongerSlow) {
    ThresholdStudy alone;
    alone.seeds = 12;
    alone.duration = 5.0;
    alone.resolution = 1.0;
    ThresholdStudy aided = alone;
    aided.aided = true;
    aided.aid_noise = 0.1;
    aided.tracking.pll_bandwidth = 3.0;
    aided.tracking.integration = 20;
    aided.tracking.dll_bandwidth = 0.1;
    const LossThresholds a = loss_thresholds(alone), b = loss_thresholds(aided);
    // 15 Hz slips where its jitter reaches a quarter of a radian or so [Kaplan2017]: 22 to 28 dB-Hz
    EXPECT_GT(a.carrier_db, 20.0);
    EXPECT_LT(a.carrier_db, 29.0);
    EXPECT_LT(b.carrier_db, a.carrier_db - 4.0);
    EXPECT_LT(b.code_db, b.carrier_db);
}

TEST(Threshold, RefusesStudies) {
    ThresholdStudy study;
    study.seeds = 0;
    EXPECT_THROW((void)loss_shares(study, 30.0), Error);
}

}  // namespace
}  // namespace schuler::receiver
