// The slope of a motion over an uncertain time: weights that are nearly Gaussian.
#include "schuler/filter/states/recent_mean.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::filter {
namespace {

using Eigen::Vector3d;

constexpr double dt = 0.0001;  // s

RecentMean after(double time, double width, double (*value)(double)) {
    RecentMean recent;
    const int steps = static_cast<int>(std::lround(time / dt));
    for (int i = 0; i <= steps; ++i) recent.add(math::Triple(value(i * dt), 0.0, 0.0), dt, width);
    return recent;
}

TEST(RecentMean, OfASteadyChangeIsTwoWidthsOld) {
    for (const double width : {0.02, 0.05, 0.1}) {
        const RecentMean recent = after(5.0, width, [](double t) { return 3.0 * t; });
        EXPECT_NEAR(recent.derivative().x(), 3.0, 1e-9) << width;
        EXPECT_NEAR(5.0 - recent.mean().x() / 3.0, 2.0 * width, 1e-9) << width;
    }
}

// By Stein's lemma the expected slope of cos(w t) over a Gaussian time of sigma s is that at the mean, times exp(-w^2 s^2 / 2).
TEST(RecentMean, LeavesOutAVibrationAsAGaussianWould) {
    constexpr double w = 2.0 * std::numbers::pi * 13.0;
    for (const double width : {0.005, 0.01, 0.02, 0.05}) {
        RecentMean recent;
        double largest = 0.0;
        for (int i = 0; i < 20000; ++i) {
            recent.add(math::Triple(0.0, std::cos(w * i * dt), 0.0), dt, width);
            if (i > 15000) largest = std::max(largest, std::abs(recent.derivative().y()) / w);
        }
        const double x = w * width;
        EXPECT_NEAR(largest, std::exp(-0.5 * x * x), 0.13) << width;
        EXPECT_NEAR(largest, std::pow(1.0 + 0.25 * x * x, -2.0), 0.02) << width;
    }
}

TEST(RecentMean, StartsFromTheFirstValueOrFromTheOneGiven) {
    RecentMean recent;
    EXPECT_EQ(recent.derivative(), Vector3d::Zero());
    recent.add(math::Triple(0.0, 0.0, -9.8), 0.01, 0.05);
    EXPECT_EQ(recent.mean(), Vector3d(0.0, 0.0, -9.8));
    EXPECT_EQ(recent.derivative(), Vector3d::Zero());
    RecentMean given;
    given.reset({1.0, 0.0, 0.0});
    given.add(math::Triple(2.0, 0.0, 0.0), 0.01, 0.05);
    EXPECT_LT(given.mean().x(), 1.1);
}

}  // namespace
}  // namespace schuler::filter
