// The fit of an inertial unit to the fixes over a long log: of many windows a thousand are used, from all of it.
#include "schuler/inspect/detail/motion/motion_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

constexpr double gravity = 9.81, speed = 10.0, turn = 0.35, late = 0.12;  // m/s^2, m/s, rad/s, s

/// A level unit that keeps its heading while it is carried round in a circle; its fixes are late.
MotionFit circling(double duration) {
    ImuSeries imu;
    GnssSeries gnss;
    imu.step = 0.05;
    gnss.step = 0.5;
    for (double t = 0.0; t < duration; t += imu.step) {
        imu.t.push_back(t);
        imu.w.emplace_back(0.001, -0.002, 0.0015);  // biases
        imu.f.emplace_back(-speed * turn * std::sin(turn * t), speed * turn * std::cos(turn * t), -gravity);
    }
    for (double t = 2.0; t < duration - 2.0; t += gnss.step) {
        gnss.t.push_back(t);
        gnss.p.emplace_back(Eigen::Vector3d::Zero());
        gnss.v.emplace_back(speed * std::cos(turn * (t - late)), speed * std::sin(turn * (t - late)), 0.0);
    }
    return fit_motion(imu, gnss, FitSource::Velocity, Eigen::Vector3d::Zero(), true, gravity);
}

TEST(MotionFitThreads, LongLogsAreFittedInAThousandWindows) {
    const MotionFit some = circling(2'000.0), many = circling(13'000.0);
    EXPECT_GT(some.windows, 150);
    EXPECT_LT(some.windows, 250);
    EXPECT_EQ(some.curves.size(), static_cast<std::size_t>(some.windows));
    ASSERT_EQ(many.windows, 1000);
    ASSERT_EQ(many.curves.size(), 1000U);
    EXPECT_TRUE(std::ranges::is_sorted(many.curves, std::ranges::less_equal(), &LagCurve::t));
    EXPECT_LT(many.curves.front().t, 30.0);
    EXPECT_GT(many.curves.back().t, 12'950.0);
    EXPECT_TRUE(std::ranges::is_sorted(many.pointings, {}, &Pointing::t));
    EXPECT_FALSE(many.pointings.empty());
    for (const MotionFit* fit : {&some, &many}) {
        ASSERT_TRUE(fit->horizontal.found);
        EXPECT_NEAR(fit->horizontal.at, late, lag_step);  // without noise the curve is no parabola between its points
        EXPECT_NEAR(fit->horizontal.at, some.horizontal.at, 1e-4);
        EXPECT_LT((fit->gyro_bias - Eigen::Vector3d(0.001, -0.002, 0.0015)).norm(), 3e-4);
    }
}

}  // namespace
}  // namespace schuler::inspect::detail
