// What is seen in an inertial unit's own record.
#include "schuler/fusion/faults/imu_faults.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace schuler::fusion::testing {
namespace {

/// Five minutes at 50 Hz whose rate about the vertical swings by 0.5 rad/s, with noise; no axis shows more than `range` of it.
filter::ImuTimeline swinging(double range, double digit = 0.0) {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0.0, 0.01);
    filter::ImuTimeline timeline;
    timeline.median_dt = 0.02;
    const auto shown = [&](double x) { return std::clamp(digit > 0.0 ? digit * std::round(x / digit) : x, -range, range); };
    for (int i = 0; i < 15000; ++i) {
        const double t = 0.02 * i;
        ImuIncrement increment;
        increment.time = Time::from_seconds(t);
        increment.dt = 0.02;
        increment.dtheta =
            0.02 * Eigen::Vector3d(shown(noise(random)), shown(noise(random)), shown(0.5 * std::sin(0.3 * t) + noise(random)));
        increment.dv = 0.02 * Eigen::Vector3d(noise(random), noise(random), -9.8 + noise(random));
        timeline.increments.push_back(increment);
    }
    return timeline;
}

TEST(ImuFaults, ARangeThatTheMotionExceedsThroughoutIsSeenAndItsSamplesAreDoubted) {
    const Doubts doubts = doubtful_stretches(swinging(0.2));
    EXPECT_NEAR(doubts.saturated, 1.0 - 2.0 / M_PI * std::asin(0.4), 0.03);
    ASSERT_FALSE(doubts.stretches.empty());
    // Over a swing beyond the range, 7.7 s, what is missing (up to 0.3 rad/s) is within three sigma of the doubt.
    double missing = 0.0, variance = 0.0;
    for (double t = 0.0; t < 10.47; t += 0.02) missing += 0.02 * std::max(0.0, 0.5 * std::sin(0.3 * t) - 0.2);
    const filter::ImuTimeline timeline = swinging(0.2);
    for (const filter::Bridge& b : doubts.stretches) {
        if (timeline.increments[b.last].time.seconds() > 10.47) continue;
        EXPECT_EQ(b.noise.accel_psd, 0.0);
        variance += b.noise.gyro_psd * 0.02 * static_cast<double>(b.last - b.first + 1);
    }
    EXPECT_LT(missing, 3.0 * std::sqrt(variance));
}

/// Of the vertical, whose accelerometer reaches no more than 8 m/s^2, the log has one value.
TEST(ImuFaults, AnAxisThatGravityExceedsIsSaturatedAndOneThatIsDeadIsNot) {
    filter::ImuTimeline timeline = swinging(1.0);
    for (ImuIncrement& i : timeline.increments) i.dv.z() = 0.02 * -8.0;
    const Doubts doubts = doubtful_stretches(timeline);
    EXPECT_NEAR(doubts.saturated, 1.0, 1e-3);
    ASSERT_FALSE(doubts.stretches.empty());
    EXPECT_GT(doubts.stretches[3].noise.accel_psd, 1.0);
    for (ImuIncrement& i : timeline.increments) i.dv.z() = 0.02 * -9.81;
    EXPECT_EQ(doubtful_stretches(timeline).saturated, 0.0);
}

/// Rare shocks take the vertical below the range that gravity exceeds in all the rest of the log.
TEST(ImuFaults, AnAxisThatGravityExceedsIsSaturatedThoughNotWithoutExceptions) {
    for (const double gravity : {8.0, 9.81}) {
        filter::ImuTimeline timeline = swinging(1.0);
        for (std::size_t i = 0; i < timeline.increments.size(); ++i) {
            const double below = i % 400 != 7 ? 0.0 : i % 1200 == 7 ? 3.0 : 0.01;
            timeline.increments[i].dv.z() = 0.02 * (below - gravity);
        }
        EXPECT_NEAR(doubtful_stretches(timeline).saturated, gravity < 9.0 ? 1.0 : 0.0, 0.01) << gravity;
    }
}

/// A unit mounted askew: the ends of its axes' ranges are not along the axes of the body.
TEST(ImuFaults, TheRangeIsThatOfTheSensorsAxes) {
    filter::ImuTimeline timeline = swinging(0.2);
    const Doubts straight = doubtful_stretches(timeline);
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy({0.02, -0.12, 0.1});
    for (ImuIncrement& i : timeline.increments) {
        i.dtheta = C_bs * i.dtheta;
        i.dv = C_bs * i.dv;
    }
    const Doubts askew = doubtful_stretches(timeline, C_bs);
    EXPECT_NEAR(askew.saturated, straight.saturated, 1e-6);
    ASSERT_EQ(askew.stretches.size(), straight.stretches.size());
    EXPECT_NEAR(askew.stretches[3].noise.gyro_psd, straight.stretches[3].noise.gyro_psd, 1e-6);
}

/// One sample of five is wild in a sixth of the log, more than any quantile of the blocks leaves out.
TEST(ImuFaults, OutliersInManyBlocksAreSeenInEach) {
    filter::ImuTimeline timeline = swinging(1.0);
    EXPECT_TRUE(doubtful_stretches(timeline).stretches.empty());
    std::mt19937 random(6);
    std::uniform_real_distribution<double> wild(-5.0, 5.0), one(0.0, 1.0);
    for (std::size_t i = 5000; i < 7500; ++i)
        if (one(random) < 0.2) timeline.increments[i].dtheta += 0.02 * Eigen::Vector3d(wild(random), wild(random), wild(random));
    double seconds = 0.0;
    for (const filter::Bridge& b : doubtful_stretches(timeline).stretches) {
        EXPECT_TRUE(b.last >= 5000 && b.first < 7500);
        seconds += 0.02 * static_cast<double>(b.last - b.first + 1);
    }
    EXPECT_GT(seconds, 47.0);
}

TEST(ImuFaults, AnAxisInsideItsRangeIsNotSaturated) {
    for (const double digit : {0.0, 0.01, 0.1, 0.3}) EXPECT_EQ(doubtful_stretches(swinging(1.0, digit)).saturated, 0.0) << digit;
}

}  // namespace
}  // namespace schuler::fusion::testing
