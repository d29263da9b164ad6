// What successive samples of an inertial unit say of its white noise.
#include "schuler/filter/update/vibration.h"

#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::filter {
namespace {

using Eigen::Vector3d;

constexpr double dt = 0.01;  // s

ImuIncrement increment(int k, const Vector3d& rate, const Vector3d& force) {
    return {Time::from_seconds(dt * k), dt, rate * dt, force * dt};
}

TEST(Vibration, WhiteNoiseIsSeenInFullAndForgottenInSeconds) {
    math::Random random(1, "vibration");
    constexpr double gyro = 1e-3, accel = 0.02;  // rad/sqrt(s), m/s/sqrt(s)
    Vibration v;
    double mean_gyro = 0.0, mean_accel = 0.0;
    constexpr int n = 20'000;
    for (int k = 1; k <= n; ++k) {
        v.add(increment(k, gyro / std::sqrt(dt) * random.normal3(), accel / std::sqrt(dt) * random.normal3()));
        mean_gyro += v.gyro_psd / n;
        mean_accel += v.accel_psd / n;
    }
    EXPECT_NEAR(mean_gyro, gyro * gyro, 0.05 * gyro * gyro);
    EXPECT_NEAR(mean_accel, accel * accel, 0.05 * accel * accel);
    for (int k = n + 1; k <= n + 500; ++k) v.add(increment(k, Vector3d::Zero(), Vector3d::Zero()));
    EXPECT_LT(v.gyro_psd, 0.01 * gyro * gyro);
}

TEST(Vibration, SmoothMotionIsNone) {
    Vibration v;
    constexpr double pi = 3.14159265358979;
    double largest = 0.0;
    for (int k = 1; k <= 2000; ++k) {  // swings by two rad/s, once a second
        const double s = std::sin(2.0 * pi * dt * k);
        v.add(increment(k, Vector3d(2.0 * s, 0.0, 1.0), Vector3d(0.0, 5.0 * s, -9.8)));
        largest = std::max(largest, std::sqrt(v.gyro_psd));
    }
    // a second difference of (2 pi dt)^2 times the amplitude
    EXPECT_LT(largest, 2.0 * std::pow(2.0 * pi * dt, 2) * std::sqrt(dt / 18.0));
}

}  // namespace
}  // namespace schuler::filter
