// What `schuler ahrs` takes for the ranges of the instruments.
#include "schuler/app/attitude/ahrs.h"
#include "schuler/core/units.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace schuler::app {
namespace {

using Eigen::Vector3d;

/// Ranges of the gyro, in deg/s, that are read out of a log of a minute at 100 Hz with these rates.
Vector3d gyro_ranges(const std::function<Vector3d(double)>& rate_deg_s, double noise_deg_s) {
    solution::LoadedDataset data;
    math::Random noise(1, "ranges");
    for (int i = 0; i < 6000; ++i) {
        const double t = 0.01 * i;
        const Vector3d rate = rate_deg_s(t) + noise_deg_s * noise.normal3();
        const Vector3d limited = rate.cwiseMin(250.0).cwiseMax(-250.0);  // of the instrument
        data.recording.imu.push_back(
            {Time::from_seconds(t), limited * units::deg, Vector3d(0.0, 0.0, -9.81) + 0.01 * noise.normal3()});
    }
    WarningLog warnings;
    AhrsRequest request;
    request.six_axis = true;
    return ahrs_input(data, request, warnings).settings.mekf.guard.gyro_range / units::deg;
}

/// To 300 deg/s for a second, `times` times, about x; about y half of that.
Vector3d swings(double t, int times) {
    const double phase = std::fmod(t, 10.0);
    const double rate = t < 10.0 * times && phase < 5.0 ? 300.0 * std::sin(std::numbers::pi * phase / 5.0) : 0.0;
    return {rate, 0.5 * rate, 0.0};
}

TEST(AhrsRanges, ALimitIsThatOfItsAxisAndIsMetTwiceOrForLong) {
    const Vector3d twice = gyro_ranges([](double t) { return swings(t, 3); }, 0.1);
    EXPECT_NEAR(twice.x(), 250.0, 1e-9);
    EXPECT_TRUE(std::isinf(twice.y()) && std::isinf(twice.z())) << twice.transpose();
    EXPECT_NEAR(gyro_ranges([](double t) { return swings(t, 1); }, 0.1).x(), 250.0, 1e-9) << "once, but for long";
    const auto touched = [](double t) { return Vector3d(t > 10.0 && t < 10.1 ? 260.0 : 0.0, 0.0, 0.0); };
    EXPECT_TRUE(std::isinf(gyro_ranges(touched, 0.1).x())) << "once and short is a coincidence";
}

TEST(AhrsRanges, SteadyTurnsAreNoLimit) {
    const auto turn = [](double t) { return Vector3d(0.0, 0.0, t > 10.0 && t < 20.0 ? 30.0 : 0.0); };
    EXPECT_TRUE(std::isinf(gyro_ranges(turn, 0.0).z())) << "of a simulation without noise";
    const auto turns = [](double t) { return Vector3d(1e-6 * t, 0.0, std::fmod(t, 20.0) > 10.0 ? 30.0 : 0.0); };
    EXPECT_TRUE(std::isinf(gyro_ranges(turns, 0.0).z())) << "three of them";
}

}  // namespace
}  // namespace schuler::app
