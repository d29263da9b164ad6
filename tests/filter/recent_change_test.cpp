#include "schuler/filter/states/recent_change.h"

#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::filter {
namespace {

using Eigen::Vector3d;

/// Change within `time` of a rate of `amplitude` rad/s that oscillates with `frequency` (Hz) about the right axis, at its peak, where it does not change.
double at_the_peak(double frequency, double amplitude, double time) {
    const double w = 2.0 * std::numbers::pi * frequency, dt = 0.001;
    const double end = std::round(5.0 * frequency) / frequency;
    RecentChange recent;
    for (double t = end - 5.0; t <= end; t += dt)
        recent.add({0.5, amplitude * std::cos(w * t), 0.0}, {0.0, -amplitude * w * std::sin(w * t), 0.0}, dt);
    return std::sqrt(recent.change_square(time * time, 0.0, dt)(1));
}

TEST(RecentChange, KnowsTheChangeOfAVibrationAtItsPeak) {
    // by acceleration within short times, by twice the variance (amplitude^2 / 2) within long ones
    EXPECT_NEAR(at_the_peak(9.0, 0.1, 0.002), 0.002 * 2.0 * std::numbers::pi * 9.0 * 0.1 / std::sqrt(2.0), 0.001);
    EXPECT_NEAR(at_the_peak(9.0, 0.1, 0.1), 0.1, 0.01);
    EXPECT_NEAR(at_the_peak(20.0, 0.1, 3.0), 0.1, 0.01);
}

TEST(RecentChange, DoesNotCountTheNoise) {
    const double psd = 1e-6, dt = 0.01;
    math::Random random(4, "rates");
    RecentChange recent;
    Vector3d before = Vector3d::Zero();
    double sum = 0.0;
    for (int i = 0; i < 2000; ++i) {
        const Vector3d rate = std::sqrt(psd / dt) * Vector3d(random.normal(), random.normal(), random.normal());
        recent.add(rate, (rate - before) / dt, dt);
        before = rate;
        if (i > 100) sum += recent.change_square(0.02 * 0.02, psd, dt).sum() / 1900.0;
    }
    EXPECT_LT(sum, 0.5 * 6.0 * psd / dt);  // of its change between two times
}

}  // namespace
}  // namespace schuler::filter
