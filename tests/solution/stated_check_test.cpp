// A lever arm that is given, judged by a simulated drive.
#include "schuler/solution/stated_check.h"

#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"

#include "fusion/car_drive.h"

#include <gtest/gtest.h>

namespace schuler::solution {
namespace {

using Eigen::Vector3d;
using namespace fusion::testing;

/// What is doubted of a lever arm that is said of the drive, whose true one is (0.4, -0.2, -1.1) m.
std::optional<LeverArmDoubt> doubt_of(const Vector3d& said) {
    sim::Scenario scenario = town_drive(21, 2.0, 200.0);
    const Recording recording = sim::simulate(scenario).recording;
    settings::Config config;
    config.filter = settings_of(scenario);
    give_start(config.filter, recording, 21);
    config.filter.gnss.lever_arm_b = said;
    WarningLog warnings;
    LoadedDataset data = settled_dataset(recording, config, warnings);
    data.given = {"gnss.lever_arm_m"};
    return doubt_of_lever_arm(data, fusion::run_filter(data.recording, data.config.filter, warnings));
}

TEST(StatedLeverArm, TheTrueOneIsNotDoubted) { EXPECT_FALSE(doubt_of({0.4, -0.2, -1.1})); }

TEST(StatedLeverArm, AWrongOneIsRefutedAndFound) {
    for (const Vector3d& wrong : {Vector3d(3.4, -0.2, -1.1), Vector3d(0.4, 4.8, -1.1)}) {
        const std::optional<LeverArmDoubt> doubt = doubt_of(wrong);
        ASSERT_TRUE(doubt);
        EXPECT_TRUE(doubt->refuted);
        EXPECT_LT((doubt->found_b - Vector3d(0.4, -0.2, -1.1)).head<2>().norm(), 0.3) << doubt->text();
        EXPECT_TRUE(doubt->settings.estimate_lever_arm);
    }
}

}  // namespace
}  // namespace schuler::solution
