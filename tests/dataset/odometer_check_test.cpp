// Odometers in another unit, with a wrong clock, another scale, or of another vehicle, against a receiver's speeds.
#include "schuler/dataset/odometer_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace schuler::dataset {
namespace {

/// Speed of a drive with stops, m/s.
double speed(double t) { return std::max(0.0, 8.0 + 7.0 * std::sin(0.11 * t) + 3.0 * std::sin(0.37 * t + 1.0)); }

struct Drive {
    std::vector<OdometerSample> odometer;
    std::vector<GnssFix> fixes;
};

/// The odometer reads `gain` times the speed, its stamps are `late`; the receiver's velocities are `latency` old.
Drive drive(double gain, double late, double latency, unsigned seed, double (*other)(double) = speed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise;
    Drive out;
    for (double t = 0.0; t < 300.0; t += 0.1) {
        OdometerSample& s = out.odometer.emplace_back();
        s.time = Time::from_seconds(100.0 + t + late);
        s.speed = gain * (other(t) + 0.05 * noise(random));
    }
    for (double t = 0.0; t < 300.0; t += 1.0) {
        GnssFix& f = out.fixes.emplace_back();
        f.time = Time::from_seconds(100.0 + t + latency);
        f.fix = FixType::Autonomous;
        f.velocity_n = {0.6 * speed(t) + 0.05 * noise(random), -0.8 * speed(t) + 0.05 * noise(random), 0.0};
    }
    return out;
}

TEST(OdometerCheck, FindsUnitScaleAndClock) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        for (const double late : {-0.8, 0.0, 0.3, 0.5, 1.3}) {
            for (const double gain : {1.0, 3.6 * 1.02, 1.0 / 0.44704, 0.8}) {
                const Drive d = drive(gain, late, 0.13, seed);
                const auto found = compare_odometer(d.odometer, d.fixes, 0.13);
                ASSERT_TRUE(found) << late << ' ' << gain;
                EXPECT_NEAR(found->lag, late, 0.05) << gain;
                EXPECT_NEAR(found->ratio * gain, 1.0, 0.01) << late;
                const auto unit = unit_of_ratio(found->ratio);
                EXPECT_EQ(unit ? unit->name : "", gain > 3.0 ? "km/h" : gain > 2.0 ? "mph" : "");
            }
        }
    }
}

TEST(OdometerCheck, SaysNothingThatTheLogDoesNotShow) {
    const Drive other = drive(1.0, 0.0, 0.0, 1, [](double t) { return 9.0 + 6.0 * std::sin(0.23 * t + 2.0); });
    EXPECT_FALSE(compare_odometer(other.odometer, other.fixes, 0.0)) << "of another vehicle";
    Drive far = drive(1.0, 5.0, 0.0, 1);
    EXPECT_FALSE(compare_odometer(far.odometer, far.fixes, 0.0)) << "five seconds are outside";
    Drive uniform = drive(1.0, 0.5, 0.0, 1);
    for (GnssFix& f : uniform.fixes) f.velocity_n = {10.0, 0.0, 0.0};
    EXPECT_FALSE(compare_odometer(uniform.odometer, uniform.fixes, 0.0));
    Drive brief = drive(3.6, 0.5, 0.0, 1);
    brief.fixes.resize(50);
    EXPECT_FALSE(compare_odometer(brief.odometer, brief.fixes, 0.0));
    EXPECT_FALSE(compare_odometer({}, brief.fixes, 0.0));
    for (OdometerSample& s : far.odometer) s.speed = not_given;
    EXPECT_FALSE(compare_odometer(far.odometer, far.fixes, 0.0));
}

}  // namespace
}  // namespace schuler::dataset
