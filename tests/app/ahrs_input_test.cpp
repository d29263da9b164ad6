// What `schuler ahrs` takes for the ranges of the instruments and the unit of the gyro, and which settings it uses.
#include "schuler/app/attitude/ahrs.h"
#include "schuler/core/units.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/solution/ignored.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>

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

/// A minute of swinging in the hand: gravity and the field as a sensor at these rates sees them, the rates themselves times `factor`.
solution::LoadedDataset swinging(double factor) {
    solution::LoadedDataset data;
    math::Random noise(2, "units");
    Eigen::Quaterniond q_nb = Eigen::Quaterniond::Identity();
    for (int i = 0; i < 6000; ++i) {
        const double t = 0.01 * i;
        const Vector3d rate(0.8 * std::sin(1.3 * t), 0.5 * std::cos(0.9 * t), 0.6 * std::sin(0.7 * t));
        q_nb = q_nb * math::quaternion_from_rotation_vector(0.01 * rate);
        const Vector3d force = q_nb.conjugate() * Vector3d(0.0, 0.0, -9.81),
                       field = q_nb.conjugate() * Vector3d(19e-6, 0.0, 45e-6);
        data.recording.imu.push_back(
            {Time::from_seconds(t), factor * (rate + 0.002 * noise.normal3()), force + 0.05 * noise.normal3()});
        data.recording.mag.push_back({Time::from_seconds(t), field + 200e-9 * noise.normal3()});
    }
    return data;
}

TEST(AhrsInput, RatesInAnotherUnitAreToldByGravityAndTheField) {
    for (const double factor : {1.0, 1.0 / units::deg, units::deg}) {
        const solution::LoadedDataset data = swinging(factor);
        WarningLog warnings;
        const AhrsInput input = ahrs_input(data, {}, warnings);
        EXPECT_NEAR((input.imu[1000].gyro - data.recording.imu[1000].gyro / factor).norm(), 0.0, 1e-6) << factor;
        const bool told =
            std::ranges::any_of(warnings.summary(), [](const std::string& w) { return w.starts_with("the gyro's rates"); });
        EXPECT_EQ(told, factor != 1.0) << factor;
    }
}

bool told(const WarningLog& warnings, std::string_view what) {
    return std::ranges::any_of(warnings.summary(), [&](const std::string& w) { return w.find(what) != std::string::npos; });
}

TEST(AhrsInput, AMagnetometersClockAndMagnetAreCorrectedAndTold) {
    const solution::LoadedDataset right = swinging(1.0);
    const Vector3d magnet(-35e-6, 20e-6, 50e-6);
    solution::LoadedDataset spoilt = right;
    for (MagSample& s : spoilt.recording.mag) s = {s.time + Duration::from_seconds(0.25), s.field_b + magnet};
    WarningLog none, warnings;
    EXPECT_EQ(ahrs_input(right, {}, none).mag_delay, 0.0);
    EXPECT_TRUE(none.summary().empty()) << none.summary().front();
    const AhrsInput input = ahrs_input(spoilt, {}, warnings);
    EXPECT_NEAR(input.mag_delay, 0.25, 0.01);
    EXPECT_NEAR((input.mag[1000].time - right.recording.mag[1000].time).seconds(), 0.0, 0.01);
    EXPECT_LT((input.magnet_b - magnet).norm(), 1e-6);
    EXPECT_LT((input.mag[1000].field_b - right.recording.mag[1000].field_b).norm(), 1e-6);
    EXPECT_TRUE(told(warnings, "0.25 s late") && told(warnings, "64 uT")) << warnings.summary().front();

    solution::LoadedDataset attached = right;  // half-way
    for (std::size_t i = attached.recording.mag.size() / 2; i < attached.recording.mag.size(); ++i)
        attached.recording.mag[i].field_b += magnet;
    WarningLog of_attached;
    EXPECT_TRUE(ahrs_input(attached, {}, of_attached).magnet_b.isZero()) << "it was not there throughout";

    spoilt.given = {"mag.time_offset_s"};
    WarningLog contradicted;
    const AhrsInput as_given = ahrs_input(spoilt, {}, contradicted);
    EXPECT_EQ(as_given.mag_delay, 0.0) << "what is given is used";
    EXPECT_TRUE(told(contradicted, "contradicts the given mag.time_offset_s"));
}

TEST(AhrsInput, SettingsWithoutAPartInTheAttitudeAreNamed) {
    settings::Config config;
    config.filter.smooth = true;
    config.filter.mag.declination = 0.1;
    config.filter.imu.gap_factor = 5.0;
    const std::vector<solution::Ignored> ignored = solution::ignored_by_attitude(
        config, {"filter.smooth", "mag.declination_deg", "imu.gap_factor", "imu.gyro_noise_deg_sqrt_h"});
    ASSERT_EQ(ignored.size(), 1u);
    EXPECT_EQ(ignored[0].key, "filter.smooth") << "and not what is as by default";
    solution::LoadedDataset data = swinging(1.0);
    data.config = config;
    WarningLog warnings;
    const AhrsInput input = ahrs_input(data, {}, warnings);
    EXPECT_EQ(input.settings.mekf.guard.gap_factor, 5.0);
    EXPECT_EQ(input.settings.mekf.heading.declination, 0.1);
    data.config.filter.mag.use = false;
    EXPECT_TRUE(ahrs_input(data, {}, warnings).mag.empty());
}

}  // namespace
}  // namespace schuler::app
