// Calm seconds in which the receiver is silent: rest only where the forces or the speeds on both sides say so.
#include "schuler/inspect/detail/motion/still.h"

#include <gtest/gtest.h>

namespace schuler::inspect::detail {
namespace {

constexpr double at_rest = 9.81;

struct Logs {
    ImuSeries imu;
    GnssSeries gnss;
};

/// A vehicle of 30 m/s whose receiver is silent from 60 to 90 s: it turns steadily all the time, or stops from 70 to 80 s.
Logs logs(bool stops) {
    Logs out;
    out.imu.step = 0.02;
    out.gnss.step = 1.0;
    constexpr double speed = 30.0, brakes = 6.0;
    for (double t = 0.0; t < 150.0; t += out.imu.step) {
        const bool braking = stops && t >= 65.0 && t < 70.0, starting = stops && t >= 80.0 && t < 85.0;
        const bool resting = stops && t >= 70.0 && t < 80.0;
        const double rate = !stops ? 0.026 : 0.0;
        // on the road it shakes while it moves
        const double shake = stops && !resting ? 0.9 * ((out.imu.size() % 2) == 0 ? 1.0 : -1.0) : 0.0;
        out.imu.t.push_back(t);
        out.imu.w.emplace_back(0.0005, -0.0003, rate + 0.1 * shake);
        out.imu.f.emplace_back((starting ? brakes : braking ? -brakes : 0.0) + shake, speed * rate, -at_rest + shake);
    }
    for (double t = 0.0; t < 150.0; t += 1.0) {
        if (t > 60.0 && t < 90.0) continue;
        out.gnss.t.push_back(t);
        out.gnss.p.emplace_back(Eigen::Vector3d::Zero());
        out.gnss.v.emplace_back(speed, 0.0, 0.0);
    }
    return out;
}

TEST(StillPeriods, ASteadyTurnWithoutTheReceiverIsNotRest) {
    const Logs turning = logs(false);
    EXPECT_FALSE(still_periods(turning.imu, turning.gnss).any());
    EXPECT_TRUE(still_periods(turning.imu, {}).any());  // nothing tells it from rest
}

TEST(StillPeriods, AStopWithoutTheReceiverIsRest) {
    const Logs stopping = logs(true);
    const StillPeriods still = still_periods(stopping.imu, stopping.gnss);
    ASSERT_EQ(still.intervals.size(), 1U);
    EXPECT_NEAR(still.intervals[0].start, 70.0, 1.1);
    EXPECT_NEAR(still.intervals[0].stop, 80.0, 1.1);
    EXPECT_NEAR(still.f_norm, at_rest, 1e-6);
}

}  // namespace
}  // namespace schuler::inspect::detail
