// What a run finds out by itself: heading, mounting, latency.
#include "fusion/car_drive.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

double heading_error_at_end(const Settings& f, const Result& r, const Recording& recording) {
    return std::abs(errors(f, r.forward.rows, recording).back().rpy.z());
}

TEST(Start, UnknownHeadingIsFoundFromTheMotion) {
    for (const std::uint64_t seed : {31u, 32u}) {
        const sim::Scenario scenario = town_drive(seed, 2.0, 120.0);
        const Recording recording = sim::simulate(scenario).recording;
        const Settings f = settings_of(scenario);
        const Result r = fuse(recording, f);
        const double error = heading_error_at_end(f, r, recording);
        EXPECT_LT(error, 3.0 * deg);
        EXPECT_NE(r.findings.alignment.find("motion"), std::string::npos) << r.findings.alignment;
        EXPECT_GT(r.findings.aligned_at, scenario.origin);
        const std::vector<analysis::ErrorRow> all = errors(f, r.forward.rows, recording);
        // From the start on the heading is within what is said of it.
        EXPECT_LT(std::abs(all.front().rpy.z()), 4.0 * all.front().std_rpy.z());
    }
}

// A barometer's height is known up to a constant: the search for the heading must not be led astray by it.
TEST(Start, BarometerOfAnotherDatumDoesNoHarm) {
    sim::Scenario scenario = town_drive(33, 2.0, 120.0);
    scenario.baro.rate = 5.0;
    Recording recording = sim::simulate(scenario).recording;
    for (BaroSample& s : recording.baro) s.height += 400.0;
    const Settings f = settings_of(scenario);
    const Result r = fuse(recording, f);
    const auto all = errors(f, r.forward.rows, recording);
    EXPECT_LT(heading_error_at_end(f, r, recording), 3.0 * deg);
    double worst = 0.0;
    for (const analysis::ErrorRow& e : all) worst = std::max(worst, std::abs(e.position.z()) / e.std_position.z());
    EXPECT_LT(worst, 5.0);
}

// Likewise a magnetometer in a car, turned by its iron: its offset is a state of the run, and the search must not trust it.
TEST(Start, TurnedMagnetometerDoesNoHarm) {
    const sim::Scenario scenario = town_drive(35, 2.0, 120.0);
    Recording recording = sim::simulate(scenario).recording;
    for (const ReferenceSample& s : recording.reference) {
        const double azimuth = 45.0 * deg;
        const Vector3d field_n(2e-5 * std::cos(azimuth), 2e-5 * std::sin(azimuth), 4e-5);
        recording.mag.push_back({s.time, math::dcm_from_rpy(s.rpy).transpose() * field_n});
    }
    const Settings f = settings_of(scenario);
    const Result r = fuse(recording, f);
    const auto all = errors(f, r.forward.rows, recording);
    EXPECT_NE(r.findings.alignment.find("motion"), std::string::npos) << r.findings.alignment;
    EXPECT_LT(std::abs(all.front().rpy.z()), 6.0 * deg);
    EXPECT_LT(heading_error_at_end(f, r, recording), 3.0 * deg);
}

TEST(Start, GivenStateIsTaken) {
    const sim::Scenario scenario = town_drive(34, 1.0, 60.0);
    const Recording recording = sim::simulate(scenario).recording;
    Settings f = settings_of(scenario);
    give_start(f, recording, 34);
    f.output_rate = 0.0;
    const Result r = fuse(recording, f);
    EXPECT_EQ(r.findings.alignment, "attitude given");
    const SolutionRow& row = r.forward.rows.front();
    EXPECT_EQ(row.time, recording.imu.front().time);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(row.std_rpy(i), f.initial.std_rpy(i), 1e-3 * f.initial.std_rpy(i));
    EXPECT_NEAR(math::wrap_pi(row.rpy.z() - f.initial.rpy.z()), 0.0, 0.2 * deg);
}

TEST(Mounting, UpsideDownAndBackwardIsFound) {
    sim::Scenario scenario = town_drive(41, 5.0);
    scenario.imu.mounting = Vector3d(174.0, 5.0, 187.0) * deg;  // over and about, then tilted
    const Recording recording = sim::simulate(scenario).recording;
    Settings f = settings_of(scenario);
    f.imu.mounting_rpy = Vector3d(180.0, 0.0, 180.0) * deg;  // as roughly known: the tilt is to be found
    f.gnss.lever_arm_b.setZero();
    for (const bool roughly_known : {true, false}) {
        if (!roughly_known) f.imu.mounting_rpy.setZero();
        f.imu.estimate_mounting = true;
        const Result r = fuse(recording, f);
        const Eigen::Matrix3d turn =
            math::dcm_from_rpy(r.findings.mounting_rpy) * math::dcm_from_rpy(scenario.imu.mounting).transpose();
        const double angle = Eigen::AngleAxisd(turn).angle();
        EXPECT_LT(angle, 2.0 * deg);
        // Roll, pitch and heading are the vehicle's from then on.
        const auto all = errors(f, r.forward.rows, recording);
        EXPECT_LT(all.back().rpy.cwiseAbs().maxCoeff(), 3.0 * deg);
        // ... and as uncertain as the mounting: the same run without that knows them too well
        Settings exact = *r.findings.in_force;
        EXPECT_NEAR(exact.imu.found_mounting_std, r.findings.std_mounting_rpy.z(), 1e-6);
        exact.imu.found_mounting_std = 0.0;
        const SolutionRow with = r.forward.rows.back(), without = fuse(recording, exact).forward.rows.back();
        ASSERT_EQ(with.position.lat, without.position.lat);
        EXPECT_NEAR(with.std_rpy.z(), std::hypot(without.std_rpy.z(), r.findings.std_mounting_rpy.z()), 2e-3 * with.std_rpy.z());
        EXPECT_NEAR(with.std_rpy.y(), std::hypot(without.std_rpy.y(), r.findings.std_mounting_rpy.z()), 2e-3 * with.std_rpy.y());
        EXPECT_NEAR(with.std_rpy.x(), without.std_rpy.x(), 2e-2 * with.std_rpy.x());
    }
}

TEST(Latency, OfTheReceiverIsFound) {
    sim::Scenario scenario = town_drive(51, 5.0);
    scenario.gnss.position_latency = scenario.gnss.velocity_latency = 0.2;
    const Recording recording = sim::simulate(scenario).recording;
    Settings f = settings_of(scenario);
    give_start(f, recording, 51);
    const Result without = fuse(recording, f);
    f.gnss.estimate_latency = true;
    const Result r = fuse(recording, f);
    EXPECT_NEAR(r.findings.position_latency, 0.2, 0.03);
    EXPECT_NEAR(r.findings.velocity_latency, 0.2, 0.03);
    const Rms late = rms(errors(f, without.forward.rows, recording), 20.0);
    const Rms found = rms(errors(f, r.forward.rows, recording), 20.0);
    EXPECT_LT(found.position, 0.7 * late.position);
}

}  // namespace
}  // namespace schuler::fusion
