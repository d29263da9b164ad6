// What is fitted to the innovations of a log: noise goes where it belongs, and no further than the devices allow.
#include "fusion/car_drive.h"

#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

/// A drive whose noise is to be found; the settings begin with the grade's.
struct Log {
    Recording recording;
    Settings settings;
};

Log log_of(sim::Scenario scenario, std::uint64_t seed) {
    if (std::get<sim::RoutePath>(scenario.path).vibration.accel == 0.0) shake(scenario);
    scenario.gnss.white_position = {0.05, 0.05, 0.1};
    Log log{sim::simulate(scenario).recording, settings_of(scenario)};
    for (GnssFix& f : log.recording.gnss) {
        f.std_position = {0.05, 0.05, 0.1};
        f.fix = FixType::RtkFixed;
    }
    give_start(log.settings, log.recording, seed);
    log.settings.imu.estimate_noise = true;
    return log;
}

TEST(Tuning, StampsThatJitterAreFoundAndNotTakenForNoiseOfTheUnit) {
    for (const double jitter : {0.0, 0.06}) {
        Log log = log_of(town_drive(81, 5.0), 81);
        math::Random random(81, "jitter");
        for (GnssFix& f : log.recording.gnss) f.time = f.time + Duration::from_seconds(jitter * random.normal());
        std::ranges::sort(log.recording.gnss, {}, &GnssFix::time);
        const Result r = fuse(log.recording, log.settings);
        const Settings& found = *r.findings.in_force;
        if (jitter == 0.0) EXPECT_LT(*found.gnss.jitter, 0.015);
        else EXPECT_NEAR(*found.gnss.jitter, jitter, 0.4 * jitter);
        EXPECT_LT(found.imu.errors.accel_noise, 4.0 * log.settings.imu.errors.accel_noise) << jitter;
        EXPECT_LT(rms(errors(log.settings, r.forward.rows, log.recording), 30.0).position, jitter == 0.0 ? 0.1 : 0.4);
    }
}

// Scale errors of some percent are nothing that a trial with fifteen states knows; white noise does not explain them either.
TEST(Tuning, NoiseOfTheUnitIsNoMoreThanItsSamplesShow) {
    sim::Scenario scenario = town_drive(82, 5.0);
    scenario.imu.errors.gyro_scale = 0.05;
    scenario.imu.errors.accel_scale = 0.05;
    const Log log = log_of(scenario, 82);
    const double dt = 0.01;
    double gyro2 = 0.0;
    const std::vector<ImuSample>& imu = log.recording.imu;
    const double per_rate = log.settings.imu.kind == ImuKind::Increments ? 1.0 / dt : 1.0;
    for (std::size_t i = 1; i + 1 < imu.size(); ++i)
        gyro2 += (imu[i - 1].gyro - 2.0 * imu[i].gyro + imu[i + 1].gyro).squaredNorm() * per_rate * per_rate * dt /
                 (18.0 * static_cast<double>(imu.size()));
    const Result solution = fuse(log.recording, log.settings);
    const Settings& found = *solution.findings.in_force;
    EXPECT_LT(found.imu.errors.gyro_noise, 1.55 * std::sqrt(gyro2));
    EXPECT_LE(*found.imu.gyro_vibration, 1.5);
}

// Errors of gains and axes are states of the trials where the run has them: noise that fixes cannot tell stays what the grade says.
TEST(Tuning, GainErrorsAreNotTakenForNoise) {
    sim::Scenario scenario = flight_in_curves(85, 0.0);
    scenario.imu.errors = sensor::imu_grade("consumer");
    const Recording recording = sim::simulate(scenario).recording;
    Settings settings = settings_of(scenario);
    settings.vehicle = VehicleKind::Air;
    settings.scale_factors = settings.misalignments = settings.imu.estimate_noise = true;
    const Settings found = *fuse(recording, settings).findings.in_force;
    EXPECT_NEAR(std::log(found.imu.errors.gyro_noise / settings.imu.errors.gyro_noise), 0.0, 1.0);
    EXPECT_NEAR(std::log(found.imu.errors.accel_noise / settings.imu.errors.accel_noise), 0.0, 1.0);
    EXPECT_LT(*found.imu.gyro_vibration, 0.5);
}

// However well the vertical velocity alone fits later: it is part of one solution with the horizontal.
TEST(Tuning, TheLatencyOfTheVerticalVelocityIsNearThatOfTheHorizontal) {
    sim::Scenario s = town_drive(84, 5.0, 120.0);
    std::get<sim::RoutePath>(s.path).vibration = {0.4, 0.0, 1.5};
    Log log = log_of(s, 84);
    log.settings.gnss.estimate_latency = true;
    constexpr std::size_t late = 3;  // fixes, 0.6 s
    for (std::size_t k = log.recording.gnss.size() - 1; k >= late; --k)
        log.recording.gnss[k].velocity_n.z() = log.recording.gnss[k - late].velocity_n.z();
    const GnssSettings found = fuse(log.recording, log.settings).findings.in_force->gnss;
    const double apart = *found.velocity_down_latency - found.velocity_latency.value_or(found.latency);
    EXPECT_GT(apart, 0.15);
    EXPECT_LE(apart, 0.26);
}

// What motion in windows has measured bounds what the likelihood of a whole trial may make of it.
TEST(Tuning, ALatencyIsLookedForWithinWhatWasMeasuredOfIt) {
    Log log = log_of(town_drive(83, 1.0, 120.0), 83);
    log.settings.imu.estimate_noise = false;
    log.settings.gnss.estimate_latency = true;
    constexpr double late = 0.3;
    for (GnssFix& f : log.recording.gnss) f.time = f.time + Duration::from_seconds(late);
    for (const double measured : {0.02, 0.15}) {  // the latter: not at all
        log.settings.gnss.latency_std = log.settings.gnss.velocity_latency_std = measured;
        const Result r = fuse(log.recording, log.settings);
        const Settings& found = *r.findings.in_force;
        if (measured < 0.1) {
            EXPECT_LE(std::abs(found.gnss.latency), 0.08);
            EXPECT_GE(found.gnss.latency_std, 0.05);  // torn between the two
        } else {
            EXPECT_NEAR(found.gnss.latency, late, 0.05);
        }
    }
}

// Noise that is to explain a string of wrong fixes opens the gates for them: the filter followed, tens of its sigmas away.
TEST(Tuning, FixesThatWereElsewhereForAWhileAreNoNoise) {
    sim::Scenario scenario = flight_in_curves(86, 0.0);
    constexpr double white = 3.0, off = 30.0;  // m
    scenario.gnss.white_position.setConstant(white);
    Recording recording = sim::simulate(scenario).recording;
    for (GnssFix& f : recording.gnss) {
        f.std_position.setConstant(not_given);
        const double t = (f.time - scenario.origin).seconds();
        if (t >= 70.0 && t < 90.0) f.position.h += off;
    }
    Settings settings = settings_of(scenario);
    settings.vehicle = VehicleKind::Air;
    settings.imu.estimate_noise = settings.gnss.estimate_std = true;
    const Result r = fuse(recording, settings);
    EXPECT_LT(r.findings.in_force->gnss.default_std_position.z(), 1.5 * white);
    std::size_t wrong = 0;
    for (const SolutionRow& row : r.forward.rows) {
        const auto truth = std::ranges::lower_bound(recording.reference, row.time, {}, &ReferenceSample::time);
        if (truth == recording.reference.end()) continue;
        const double error = std::abs(row.position.h - truth->position.h);
        wrong += error > std::max(1.0, 5.0 * row.std_position.z()) ? 1 : 0;
    }
    EXPECT_LT(static_cast<double>(wrong), 0.02 * static_cast<double>(r.forward.rows.size()));
}

}  // namespace
}  // namespace schuler::fusion
