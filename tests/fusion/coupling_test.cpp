// The separate scheme's gains, the aggressive loose coupling, the receiver's aiding and its integrity.
#include "fusion/car_drive.h"

#include "schuler/core/error.h"
#include "schuler/filter/integrity/integrity.h"
#include "schuler/filter/update/correction_period.h"
#include "schuler/filter/update/receiver_aiding.h"
#include "schuler/filter/update/separate.h"
#include "schuler/math/random.h"
#include "schuler/sim/inverse_imu.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace schuler::fusion {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace testing;

// Poles of the whole vertical channel with its barometer: all at -1/tau.
TEST(SeparateScheme, BarometerLoopHasThreeEqualRoots) {
    for (const double tau : {20.0, 100.0, 300.0}) {
        const VerticalGains g = vertical_gains(tau);
        const double c = 2.0 * 9.80665 / 6371000.0;
        Matrix3d A;  // height, velocity, correction of the acceleration
        A << -g.height, 1.0, 0.0, c - g.velocity, 0.0, -1.0, g.acceleration, 0.0, 0.0;
        for (const auto& root : A.eigenvalues())
            EXPECT_NEAR(std::abs(root * tau + 1.0), 0.0, 2e-4);  // a triple root is badly conditioned
    }
}

// The gain columns as they act: a height error decays under a barometer at 10 Hz with the loop's roots, and a constant accelerometer
// error leaves nothing.
TEST(SeparateScheme, BarometerGainsCloseTheLoopInTheRightSense) {
    const double dt = 0.1, tau = 50.0, c = 2.0 * 9.80665 / 6371000.0;
    const Matrix3d C = math::quaternion_from_rpy({0.2, -0.1, 1.0}).toRotationMatrix();
    const estim::StateVector K = barometer_gains(16, C, dt, tau).col(0);
    double d = 5.0, v = 0.2;  // errors down
    Vector3d bias = C.transpose() * Vector3d(0.0, 0.0, 0.01);
    for (int k = 0; k < 20000; ++k) {
        d += dt * v;
        v += dt * (c * d - (C * bias).z());  // v' = -C db
        const double innovation = -d;        // height against height, row -1
        d -= K(Layout::position + 2) * innovation;
        v -= K(Layout::velocity + 2) * innovation;
        bias -= K.segment<3>(Layout::accel_bias) * innovation;
    }
    EXPECT_NEAR(d, 0.0, 1e-3);
    EXPECT_NEAR(v, 0.0, 1e-5);
    EXPECT_NEAR((C * bias).z(), 0.0, 1e-6);
}

TEST(SeparateScheme, ShareOfAContinuousCorrection) {
    double left = 1.0;
    for (int k = 0; k < 30; ++k) left *= 1.0 - correction_share(1.0, 30.0);
    EXPECT_NEAR(left, std::exp(-1.0), 1e-14);
}

// After (3.4.9): with R -> infinity the growth is that of the gyro alone; the period is its inverse, within a second and 21 minutes.
TEST(CorrectionPeriod, InvertsTheGrowth) {
    const InertialErrorBounds b{1e-3, 5e-6, 1e-2};
    for (const double t : {2.0, 30.0, 300.0}) EXPECT_NEAR(correction_period(b, attitude_growth(b, t)), t, 1e-4);
    EXPECT_NEAR(attitude_growth(b, 10.0), 5e-5 + ((1e-3 * 9.80665 + 1e-2) * 50.0 + 9.80665 * 5e-6 * 1000.0 / 6.0) / 6371000.0,
                1e-12);
    EXPECT_NEAR(correction_period({}, 1e-3), 0.5 * M_PI * std::sqrt(6371000.0 / 9.80665), 1e-6);
    EXPECT_NEAR(correction_period({1.0, 1.0, 100.0}, 1e-9), 1.0, 1e-4);
}

// Range, rate and acceleration to a moving transmitter against differences of the range along the true path.
TEST(ReceiverAiding, RatesAreTheDerivativesOfTheRange) {
    const earth::Earth earth;
    sim::FigureEightPath eight{{0.8, 0.2, 3000.0}, 0.3, 4000.0, 2000.0, 60.0, 100.0, 0.102};
    const auto path = sim::make_path(eight, earth.ellipsoid);
    const Vector3d lever(2.0, 0.5, -1.0);
    const auto nav_at = [&](double t) { return sim::nav_state(path->at(t), Time::from_seconds(t)); };
    const auto antenna = [&](double t) {
        const NavState n = nav_at(t);
        return Vector3d(earth::ecef_from_geodetic(earth.ellipsoid, n.position).r +
                        earth::C_en(n.position.lat, n.position.lon) * (n.q_nb.toRotationMatrix() * lever));
    };
    const auto satellite = [](double t) {
        return Vector3d(2.0e7 + 900.0 * t - 0.2 * t * t, 1.2e7 - 2500.0 * t + 0.1 * t * t, 1.0e7 + 1500.0 * t);
    };
    const auto range = [&](double t) { return (antenna(t) - satellite(t)).norm(); };
    for (const double t : {7.0, 22.0, 41.0}) {
        const sim::InertialInput felt = sim::inertial_input(earth, path->at(t));
        const EarthFixedMotion here = antenna_motion(earth, nav_at(t), felt.f_b, felt.w_ib_b, lever);
        const EarthFixedMotion there{satellite(t), {900.0 - 0.4 * t, -2500.0 + 0.2 * t, 1500.0}, {-0.4, 0.2, 0.0}};
        const NavState n = nav_at(t);
        Eigen::Matrix<double, 6, 6> P = Eigen::Matrix<double, 6, 6>::Zero();
        P.diagonal() << 4.0, 4.0, 4.0, 0.01, 0.01, 0.01;
        const LineOfSightPrediction seen = line_of_sight_prediction(here, there, earth::C_en(n.position.lat, n.position.lon), P);
        const double h = 0.05;
        EXPECT_NEAR(seen.range, range(t), 1e-6);
        EXPECT_NEAR(seen.rate, (8.0 * (range(t + h) - range(t - h)) - (range(t + 2 * h) - range(t - 2 * h))) / (12.0 * h), 1e-5);
        // The lever arm's turn is taken as steady: 2 m times an angular acceleration of 0.02 rad/s^2.
        EXPECT_NEAR(seen.acceleration, (range(t + h) - 2.0 * range(t) + range(t - h)) / (h * h), 0.06);
        EXPECT_NEAR(seen.std_range, 2.0, 1e-12);
        EXPECT_NEAR(seen.std_rate, 0.1, 1e-12);
    }
}

TEST(Integrity, TestsOfOneFix) {
    IntegritySettings s;
    ChannelHealth health;
    Examined e{MeasurementKind::GnssPosition, Time::from_seconds(12.0), {60.0, 0.0, 0.0}, 3.0};
    EXPECT_TRUE(within_tolerance(e, health, s));  // nothing to extrapolate from yet
    health.used = Time::from_seconds(10.0);
    EXPECT_TRUE(within_tolerance(e, health, s));  // 30 m/s^2 for 2 s: 60 m
    e.innovation.x() = 60.0 + 5.0 * std::sqrt(3.0) + 0.1;
    EXPECT_FALSE(within_tolerance(e, health, s));
    EXPECT_EQ(failed_test(e, health, s), IntegrityTest::Tolerance);
    e.trace = 100.0;  // a navigation that is uncertain by itself contradicts nothing
    EXPECT_TRUE(within_tolerance(e, health, s));
    e.trace = 3.0;
    e.kind = MeasurementKind::GnssVelocity;
    e.innovation.x() = 68.0;  // 30 m/s^2 for 2 s and 8.7 m/s
    EXPECT_TRUE(within_tolerance(e, health, s));
    e.trace = 68.0 * 68.0 / 10.0 * 0.999;
    EXPECT_EQ(failed_test(e, health, s), IntegrityTest::Innovation);
    e.trace *= 1.002;
    EXPECT_EQ(failed_test(e, health, s), std::nullopt);
}

Examined at(double t, MeasurementKind kind) { return {kind, Time::from_seconds(t), Eigen::Vector3d::Zero(), 1.0}; }

TEST(Integrity, ReadmissionTakesAgreementForItsTime) {
    IntegritySettings s;
    ChannelHealth health;
    health.excluded = true;
    for (int t = 0; t < 5; ++t) EXPECT_FALSE(readmits(health, nullptr, at(t, MeasurementKind::GnssVelocity), true, s));
    EXPECT_FALSE(readmits(health, nullptr, at(5.0, MeasurementKind::GnssVelocity), false, s));
    for (int t = 6; t < 16; ++t) EXPECT_FALSE(readmits(health, nullptr, at(t, MeasurementKind::GnssVelocity), true, s));
    EXPECT_TRUE(readmits(health, nullptr, at(16.0, MeasurementKind::GnssVelocity), true, s));
    EXPECT_FALSE(health.excluded);
}

/// A velocity that is wrong by 0.2 m/s comes within the sigma of the unaided estimate after a while: not readmitted as long as it
/// looks as it did, but ten seconds after it is right. An estimate that is much more uncertain than the fault decides nothing.
TEST(Integrity, AFaultThatIsStillThereIsNotAgreement) {
    IntegritySettings s;
    math::Random random(3, "noise");
    const auto seconds_until = [&](const Eigen::Vector3d& fault, double recovers, double sigma, const Eigen::Vector3d& error) {
        ChannelHealth health;
        health.excluded = true;
        health.fault = -Eigen::Vector3d(0.14, 0.14, 0.0);
        const Eigen::Vector3d state = Eigen::Vector3d::Constant(sigma * sigma), noise = Eigen::Vector3d::Constant(0.05 * 0.05);
        for (int t = 0; t < 300; ++t) {
            const Eigen::Vector3d wrong = t < recovers ? fault : Eigen::Vector3d(Eigen::Vector3d::Zero());
            const Examined fix{
                MeasurementKind::GnssVelocity, Time::from_seconds(t), error - wrong - 0.05 * random.normal3(), 1.0, state, noise};
            if (readmits(health, nullptr, fix, true, s)) return t;
        }
        return 300;
    };
    const Eigen::Vector3d fault(0.14, 0.14, 0.0), none = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& error : {none, Eigen::Vector3d(0.04, -0.03, 0.02), Eigen::Vector3d(-0.04, -0.03, 0.0)}) {
        const int t = seconds_until(fault, 100.0, 0.05, error);
        EXPECT_GE(t, 105) << error.transpose();
        EXPECT_LE(t, 121) << error.transpose();
    }
    EXPECT_EQ(seconds_until(none, 0.0, 0.05, none), 10);
    EXPECT_LE(seconds_until(fault, 1e9, 0.3, none), 60);
}

/// The estimate followed a receiver that drifted, and the receiver recovers: what fails then is the estimate.
TEST(Integrity, TheEndOfAFaultIsNotAnother) {
    ChannelHealth position, velocity;
    const auto fix = [](MeasurementKind kind, double t, double x, double y) {
        return Examined{kind, Time::from_seconds(t), {x, y, 0.0}, 1.0};
    };
    const auto ends = [&](MeasurementKind kind, double t, double x, double y) {
        return ends_a_fault(kind == MeasurementKind::GnssPosition ? position : velocity, velocity, fix(kind, t, x, y));
    };
    EXPECT_FALSE(ends(MeasurementKind::GnssVelocity, 500.0, 0.07, 0.07)) << "there was no fault";
    velocity.fault = {-0.07, -0.07, 0.0};  // the receiver was faster than the estimate
    velocity.faulty = Time::from_seconds(400.0);
    EXPECT_TRUE(ends(MeasurementKind::GnssVelocity, 500.0, 0.06, 0.05));
    EXPECT_TRUE(ends(MeasurementKind::GnssPosition, 500.0, 6.0, 7.0));
    EXPECT_FALSE(ends(MeasurementKind::GnssVelocity, 500.0, -0.06, -0.05)) << "the same again";
    EXPECT_FALSE(ends(MeasurementKind::GnssVelocity, 500.0, 0.07, -0.07)) << "across";
    EXPECT_FALSE(ends(MeasurementKind::GnssVelocity, 500.0, 0.2, 0.2)) << "larger";
    EXPECT_FALSE(ends(MeasurementKind::GnssPosition, 500.0, 15.0, 15.0)) << "larger than 0.1 m/s in 100 s";
    EXPECT_FALSE(ends(MeasurementKind::GnssVelocity, 1100.0, 0.06, 0.05)) << "long ago";
    velocity.returned = true;
    EXPECT_FALSE(ends(MeasurementKind::GnssVelocity, 500.0, 0.06, 0.05)) << "twice";
}

// A receiver that drifts by 0.3 m/s: its positions agree for long after its velocities no longer do.
TEST(Integrity, APositionWaitsForTheVelocityThatWasExcludedWithIt) {
    IntegritySettings s;
    ChannelHealth position, velocity;
    const auto exclude = [&] {
        position = velocity = {};
        position.excluded = velocity.excluded = position.together = velocity.together = true;
    };
    exclude();
    for (int t = 0; t < 60; ++t) {
        EXPECT_FALSE(readmits(position, &velocity, at(t, MeasurementKind::GnssPosition), true, s)) << t;
        EXPECT_FALSE(readmits(velocity, nullptr, at(t, MeasurementKind::GnssVelocity), false, s)) << t;
    }
    int t = 60;
    while (t < 90 && !readmits(position, &velocity, at(t, MeasurementKind::GnssPosition), true, s)) {
        if (velocity.excluded) (void)readmits(velocity, nullptr, at(t, MeasurementKind::GnssVelocity), true, s);
        ++t;
    }
    EXPECT_EQ(t, 71);

    // a velocity does not wait for a position that is wrong alone
    exclude();
    for (t = 0; t < 10; ++t) {
        EXPECT_FALSE(readmits(position, &velocity, at(t, MeasurementKind::GnssPosition), false, s)) << t;
        EXPECT_FALSE(readmits(velocity, nullptr, at(t, MeasurementKind::GnssVelocity), true, s)) << t;
    }
    EXPECT_TRUE(readmits(velocity, nullptr, at(10.0, MeasurementKind::GnssVelocity), true, s));

    // a receiver that has no velocities any more is not waited for
    exclude();
    EXPECT_FALSE(readmits(velocity, nullptr, at(0.0, MeasurementKind::GnssVelocity), false, s));
    t = 0;
    while (t < 40 && !readmits(position, &velocity, at(t, MeasurementKind::GnssPosition), true, s)) ++t;
    EXPECT_EQ(t, 30);
}

/// An aircraft in a figure of eight with good sensors; started from the truth.
struct CoupledFlight {
    sim::Scenario scenario;
    Settings settings;
    double known_heading = 0.0;  // rad, if above 0: the sigma at the start

    explicit CoupledFlight(std::uint64_t seed) {
        scenario.seed = seed;
        scenario.duration = 400.0;
        scenario.origin = Time::from_seconds(1000.0);
        scenario.path = sim::FigureEightPath{{0.9, 0.5, 2000.0}, 0.3, 6000.0, 3000.0, 120.0, 100.0, 0.102};
        scenario.imu.rate = 20.0;
        scenario.imu.errors = sensor::imu_grade("tactical");
        scenario.imu.errors.gyro_scale = scenario.imu.errors.accel_scale = 0.0;
        scenario.imu.errors.gyro_misalignment = scenario.imu.errors.accel_misalignment = 0.0;
        scenario.imu.errors.gyro_turn_on_bias = 0.0;
        scenario.imu.errors.accel_turn_on_bias *= 0.1;
        scenario.gnss.white_position = {1.0, 1.0, 1.5};
        scenario.gnss.white_velocity.setConstant(0.03);
        scenario.baro = {1.0, 0.5, 3.0, 0.02};
        settings.earth = scenario.earth;
        settings.vehicle = VehicleKind::Air;
        settings.imu.kind = scenario.imu.kind;
        settings.imu.errors = scenario.imu.errors;
        settings.baro.std = 0.5;
        settings.baro.bias_std = 3.0;
        settings.baro.bias_walk = 0.02;
        settings.constraints.zero_velocity = false;
    }
    Result run(Recording& recording) {
        WarningLog unheard;
        return run(recording, unheard);
    }
    Result run(Recording& recording, WarningLog& warnings) {
        recording = sim::simulate(scenario).recording;
        give_start(settings, recording, scenario.seed);
        if (known_heading > 0.0) settings.initial.std_rpy.z() = known_heading;
        return run_filter(recording, settings, warnings);
    }
};

/// Largest and root mean square horizontal error from `from` seconds on, and the mean of its squared standardised value.
struct Horizontal {
    double largest = 0.0, rms = 0.0, nees = 0.0;
};
Horizontal horizontal(const Result& result, const Recording& recording, double from) {
    Horizontal h;
    double n = 0.0;
    for (const analysis::ErrorRow& e : analysis::errors_against(earth::Earth{}, result.forward.rows, recording.reference)) {
        if (e.time.seconds() - 1000.0 < from) continue;
        const double r = e.position.head<2>().norm();
        h.largest = std::max(h.largest, r);
        h.rms += r * r;
        h.nees += 0.5 * e.position.head<2>().cwiseQuotient(e.std_position.head<2>()).squaredNorm();
        n += 1.0;
    }
    h.rms = std::sqrt(h.rms / n);
    h.nees /= n;
    return h;
}

// Whatever its gains, the separate scheme says truly how good it is; the filter is better.
TEST(SeparateScheme, IsHonestAndWorseThanTheFilter) {
    double continuous = 0.0, restart = 0.0, loose = 0.0, nees = 0.0, nees_restart = 0.0;
    const int seeds = 8;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        CoupledFlight flight(seed);
        Recording recording;
        loose += horizontal(flight.run(recording), recording, 60.0).rms / seeds;
        flight.settings.coupling = Coupling::Separate;
        const Horizontal c = horizontal(flight.run(recording), recording, 60.0);
        flight.settings.separate.restart_period = 60.0;
        const Horizontal r = horizontal(flight.run(recording), recording, 60.0);
        continuous += c.rms / seeds;
        restart += r.rms / seeds;
        nees += c.nees / seeds;
        nees_restart += r.nees / seeds;
    }
    EXPECT_LT(loose, 0.8 * continuous);
    EXPECT_LT(loose, 0.8 * restart);
    // Sixteen tilts that nobody estimates decide: chi-square of 16 over 16.
    for (const double mean : {nees, nees_restart}) {
        EXPECT_GT(mean, 0.3);
        EXPECT_LT(mean, 2.3);
    }
}

TEST(LooseKind, AggressiveUsesTheSameInformationInParts) {
    CoupledFlight flight(3);
    Recording recording;
    const Horizontal standard = horizontal(flight.run(recording), recording, 60.0);
    flight.settings.loose_kind = LooseKind::Aggressive;
    const Horizontal aggressive = horizontal(flight.run(recording), recording, 60.0);
    EXPECT_NEAR(aggressive.rms / standard.rms, 1.0, 0.25);
    EXPECT_NEAR(aggressive.nees / standard.nees, 1.0, 0.4);
    EXPECT_NE(aggressive.rms, standard.rms);
}

// Without process noise what a fix says of its own time is the same whenever it is used: after the last part both filters know as much.
TEST(LooseKind, PartsOfASparseFixSpeakOfItsTime) {
    CoupledFlight flight(4);
    flight.scenario.gnss.rate = 0.1;
    sensor::ImuErrorModel& errors = flight.settings.imu.errors;
    errors.gyro_noise = errors.accel_noise = 1e-9;
    errors.gyro_bias_time = errors.accel_bias_time = 1e9;  // constants
    flight.scenario.imu.errors = errors;
    flight.scenario.baro.rate = 0.0;
    flight.known_heading = 0.01;  // what an unknown one withholds is noise, and depends on the corrections in between
    flight.settings.constraints.gate_probability = 0.0;  // integrating at 20 Hz has errors too, which no noise stands for here
    Recording recording;
    const Result standard = flight.run(recording);
    flight.settings.loose_kind = LooseKind::Aggressive;
    const Result aggressive = flight.run(recording);
    ASSERT_EQ(standard.forward.rows.size(), aggressive.forward.rows.size());
    int compared = 0;
    for (std::size_t i = 0; i < standard.forward.rows.size(); ++i) {
        const SolutionRow &a = standard.forward.rows[i], &b = aggressive.forward.rows[i];
        const double t = a.time.seconds() - 1000.0;
        if (t < 30.0 || std::abs(std::fmod(t, 10.0) - 9.5) > 0.4) continue;  // all parts of a fix are used, the next is not there
        ++compared;
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(b.std_position(k) / a.std_position(k), 1.0, 0.01) << t;
            EXPECT_NEAR(b.std_velocity(k) / a.std_velocity(k), 1.0, 0.01) << t;
            EXPECT_NEAR(b.std_rpy(k) / a.std_rpy(k), 1.0, 0.01) << t;
        }
    }
    EXPECT_GT(compared, 20);
}

// A position that ramps away by 1 m/s: the filter alone follows it, the monitor excludes the receiver and takes it back afterwards.
TEST(Integrity, SlowRampIsFoundExcludedAndTheReceiverReadmitted) {
    CoupledFlight flight(5);
    flight.settings.gnss.use_velocity = false;  // a velocity without the fault would tell at once
    Recording recording;
    flight.settings.integrity.use = true;
    const Result healthy = flight.run(recording);
    EXPECT_TRUE(healthy.alerts.empty());
    flight.scenario.faults = {{sim::Channel::Gnss, sim::FaultKind::Ramp, 200.0, 100.0, 1.0, Vector3d::UnitX()}};
    const Result guarded = flight.run(recording);
    const Horizontal controlled = horizontal(guarded, recording, 60.0);
    flight.settings.integrity.use = false;
    flight.settings.constraints.gate_probability = 0.0;
    const Horizontal open = horizontal(flight.run(recording), recording, 60.0);
    EXPECT_GT(open.largest, 60.0);
    EXPECT_LT(controlled.largest, 0.5 * open.largest);
    ASSERT_GE(guarded.alerts.size(), 2u);
    const double found = guarded.alerts.front().time.seconds() - 1200.0;
    EXPECT_GT(found, 0.0);
    EXPECT_LT(found, 70.0);
    EXPECT_EQ(guarded.alerts.back().test, IntegrityTest::Readmitted);
}

TEST(Integrity, StepsAreRefusedAtOnceAndSmootherIsRefusedToo) {
    CoupledFlight flight(6);
    flight.settings.integrity.use = true;
    flight.scenario.faults = {{sim::Channel::Gnss, sim::FaultKind::Step, 200.0, 60.0, 100.0, Vector3d::UnitY()}};
    Recording recording;
    const Result guarded = flight.run(recording);
    EXPECT_LT(horizontal(guarded, recording, 60.0).largest, 20.0);
    ASSERT_FALSE(guarded.alerts.empty());
    EXPECT_NEAR(guarded.alerts.front().time.seconds() - 1200.0, 2.0, 1.01);  // three in a row
    flight.settings.smooth = true;
    EXPECT_THROW((void)flight.run(recording), Error);
}

/// The separate scheme with a MEMS unit, whose attitude nobody corrects: tenths of a radian after minutes. From seed 2 on: seed 1 draws a
/// heading at the start that is wrong by 2.7 sigma, for which the gate refuses the fixes in the first turn.
struct TiltedFlight : CoupledFlight {
    explicit TiltedFlight(std::uint64_t seed) : CoupledFlight(seed) {
        scenario.duration = 300.0;
        scenario.imu.errors = mems();
        settings.imu.errors = scenario.imu.errors;
        settings.coupling = Coupling::Separate;
        settings.integrity.use = true;
    }
};

// The vertical acceleration of a tilted solution is of the second order: nothing that a receiver would have to answer for.
TEST(SeparateScheme, ATiltedSolutionExcludesNoHealthyReceiver) {
    for (const bool barometer : {true, false})
        for (std::uint64_t seed = 2; seed <= 7; ++seed) {
            TiltedFlight flight(seed);
            if (!barometer) flight.scenario.baro.rate = 0.0;
            Recording recording;
            for (const Alert& a : flight.run(recording).alerts)
                EXPECT_EQ(a.test, IntegrityTest::Unjudged) << "seed " << seed << ", " << a.time.seconds() - 1000.0 << " s";
        }
}

TEST(SeparateScheme, ATiltedSolutionFindsAStep) {
    for (std::uint64_t seed = 2; seed <= 5; ++seed) {
        TiltedFlight flight(seed);
        flight.scenario.faults = {{sim::Channel::Gnss, sim::FaultKind::Step, 150.0, 30.0, 1000.0, Vector3d::UnitY()}};
        Recording recording;
        const Result result = flight.run(recording);
        ASSERT_FALSE(result.alerts.empty()) << seed;
        EXPECT_NEAR(result.alerts.front().time.seconds() - 1150.0, 2.0, 1.01) << seed;  // three in a row
    }
}

// A gyro error of 0.2 rad/s is a radian of tilt after 5 s; in a turn it would not add up for long.
TEST(SeparateScheme, NothingIsJudgedBeyondARadian) {
    TiltedFlight flight(1);
    flight.settings.imu.errors.gyro_turn_on_bias = 0.2;
    flight.scenario.faults = {{sim::Channel::Gnss, sim::FaultKind::Step, 200.0, 30.0, 1000.0, Vector3d::UnitY()}};
    Recording recording;
    WarningLog warnings;
    const Result result = flight.run(recording, warnings);
    ASSERT_EQ(result.alerts.size(), 1u);
    EXPECT_EQ(result.alerts.front().test, IntegrityTest::Unjudged);
    EXPECT_NEAR(result.alerts.front().time.seconds() - 1000.0, 5.5, 1.0);
    EXPECT_EQ(std::ranges::count(warnings.topics(), "gnss.unjudged"), 1);
    EXPECT_EQ(result.counters.gnss_rejected, 0u);
}

}  // namespace
}  // namespace schuler::fusion
