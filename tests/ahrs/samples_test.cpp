// Samples that would poison a filter, logs that end in the middle, and the offline pass.
#include "ahrs/simulated_motion.h"

#include "schuler/ahrs/mekf.h"
#include "schuler/ahrs/run.h"
#include "schuler/core/error.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

namespace schuler::ahrs {
namespace {

using Eigen::Vector3d;
using namespace testing;

struct Log {
    std::vector<ImuSample> imu;
    std::vector<MagSample> mag;
    std::vector<Instant> truth;
};

Log log_of(const Motion& m, std::uint64_t seed) {
    Log l;
    l.truth = simulated(m, seed);
    for (const Instant& i : l.truth) {
        l.imu.push_back({Time::from_seconds(i.time), i.gyro, i.accel});
        l.mag.push_back({Time::from_seconds(i.time), i.field});
    }
    return l;
}

/// Largest rotation between estimate and truth after `from`, deg; and the RMS.
std::pair<double, double> errors_of(const RunResult& r, const Log& l, double from) {
    double largest = 0.0, square = 0.0, n = 0.0;
    const std::size_t lost = l.truth.size() - r.rows.size();
    for (std::size_t i = 0; i < r.rows.size(); ++i) {
        const Instant& t = l.truth[i + lost];
        if (t.time < from) continue;
        const double e = r.rows[i].q_nb.angularDistance(t.q_nb) / units::deg;
        largest = std::max(largest, e);
        square += e * e;
        n += 1.0;
    }
    return {largest, std::sqrt(square / n)};
}

/// Share of the rows from `from` to `to` (s) whose heading is off by more than three sigma.
double beyond_three_sigma(const RunResult& r, const Log& l, double from, double to) {
    double beyond = 0.0, n = 0.0;
    const std::size_t lost = l.truth.size() - r.rows.size();
    for (std::size_t i = 0; i < r.rows.size(); ++i) {
        const Instant& t = l.truth[i + lost];
        if (t.time < from || t.time > to) continue;
        const double error = math::wrap_pi(math::rpy_from_quaternion(r.rows[i].q_nb).z() - math::rpy_from_quaternion(t.q_nb).z());
        beyond += std::abs(error) > 3.0 * r.rows[i].std_phi.z() ? 1.0 : 0.0;
        n += 1.0;
    }
    return beyond / n;
}

TEST(AhrsSamples, BadOnesAreBridgedAndCounted) {
    Motion m;
    m.gyro_bias = Vector3d(0.2, -0.1, 0.3) * units::deg_per_s;
    Log l = log_of(m, 3);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 3000; i < 3020; ++i) l.imu[i].gyro.y() = nan;
    for (std::size_t i = 4000; i < 4050; ++i) l.imu[i].accel = Vector3d(160.0, 1e-3 * static_cast<double>(i), 0.0);
    for (std::size_t i = 5000; i < 5200; ++i) l.imu[i].accel = l.imu[4999].accel;
    for (std::size_t i = 6000; i < 6300; ++i) l.mag[i].field_b = l.mag[5999].field_b;
    for (std::size_t i = 7000; i < 7100; ++i) l.mag[i].field_b.x() = nan;
    RunSettings s;
    s.mekf.guard.accel_range.setConstant(156.0);
    const RunResult r = run(l.imu, l.mag, {}, s);
    EXPECT_EQ(r.counters.gyro.not_finite, 20u);
    EXPECT_EQ(r.counters.accel.saturated, 50u);
    EXPECT_EQ(r.counters.accel.stuck, 200u - 24u);
    EXPECT_EQ(r.counters.field.stuck, 300u - 24u);
    EXPECT_EQ(r.counters.field.not_finite, 100u);
    EXPECT_LT(errors_of(r, l, 20.0).first, 4.0);
    for (const AttitudeRow& row : r.rows) ASSERT_TRUE(row.q_nb.coeffs().allFinite());
}

TEST(AhrsSamples, AGapIsDoubtedNotIntegrated) {
    Motion m;
    Log l = log_of(m, 4);
    l.imu.erase(l.imu.begin() + 6000, l.imu.begin() + 6300);  // 3 s, in which the sensor turned
    const RunResult r = run(l.imu, l.mag, {}, {});
    EXPECT_EQ(r.counters.gaps, 1u);
    const auto at = [&](double t) {
        return *std::ranges::find_if(r.rows, [&](const AttitudeRow& row) { return row.time.seconds() >= t; });
    };
    EXPECT_GT(at(63.1).std_phi.x(), 10.0 * at(59.0).std_phi.x());
    EXPECT_LT(at(119.9).q_nb.angularDistance(l.truth.back().q_nb), 5.0 * units::deg);
}

TEST(AhrsOffline, SmoothingLooksAheadAndSaysSo) {
    Motion m;
    m.gyro_bias = Vector3d(0.2, -0.1, 0.3) * units::deg_per_s;
    m.rest = 0.0;
    m.sway_std = 0.3;
    m.field_std = 2e-6;
    const Log l = log_of(m, 8);
    RunSettings s;
    const RunResult online = run(l.imu, l.mag, {}, s);
    s.offline = true;
    const RunResult offline = run(l.imu, l.mag, {}, s);
    EXPECT_EQ(online.rows.size(), offline.rows.size());
    EXPECT_LT(errors_of(offline, l, 1.0).second, 0.6 * errors_of(online, l, 1.0).second);
    // smooth: no step between neighbouring samples beyond what the sensor turned
    for (std::size_t i = 1; i < offline.rows.size(); ++i) {
        const double estimated = offline.rows[i].q_nb.angularDistance(offline.rows[i - 1].q_nb);
        ASSERT_LT(estimated, 80.0 * units::deg_per_s * m.dt) << i;
    }
    // at the end there is nothing to look ahead to
    EXPECT_LT(offline.rows.back().q_nb.angularDistance(online.rows.back().q_nb), 1.0 * units::deg);
}

TEST(AhrsOffline, TheFieldDoesNotTiltItEither) {
    Motion m;
    const Log clean = log_of(m, 9);
    m.disturbed_from = 40.0;
    m.disturbed_to = 80.0;
    const Log disturbed = log_of(m, 9);
    RunSettings s;
    s.offline = true;
    const RunResult a = run(clean.imu, clean.mag, {}, s), b = run(disturbed.imu, disturbed.mag, {}, s);
    for (std::size_t i = 0; i < a.rows.size(); ++i) {
        const Vector3d up_a = a.rows[i].q_nb.conjugate() * Vector3d::UnitZ(),
                       up_b = b.rows[i].q_nb.conjugate() * Vector3d::UnitZ();
        ASSERT_LT((up_a - up_b).norm(), 1e-12);
    }
}

TEST(AhrsSamples, AfterAGapInWhichItWasTurnedOverTheHorizonIsFoundAgain) {
    const auto attitude = [](double t) {
        return math::quaternion_from_rpy(
            {t < 60.0 ? 0.2 * std::sin(t) : 2.3 + 0.2 * std::sin(t), 0.3 * std::sin(0.7 * t), 0.5 * t});
    };
    math::Random noise(19, "gap");
    Log l;
    for (double t = 0.01; t < 120.0; t += 0.01) {
        if (t > 58.5 && t < 61.5) continue;
        const Eigen::Quaterniond q = attitude(t);
        const Vector3d rate = math::rotation_vector_from_quaternion(attitude(t - 0.01).conjugate() * q) / 0.01;
        l.imu.push_back({Time::from_seconds(t), rate + 1e-3 * noise.normal3(),
                         q.conjugate() * Vector3d(0.0, 0.0, -9.81) + 0.05 * noise.normal3()});
        l.mag.push_back({Time::from_seconds(t), q.conjugate() * Vector3d(19e-6, 0.0, 46e-6) + 3e-7 * noise.normal3()});
        l.truth.push_back({t, {}, {}, {}, q});
    }
    for (const bool offline : {false, true}) {
        RunSettings s;
        s.offline = offline;
        const RunResult r = run(l.imu, l.mag, {}, s);
        EXPECT_LT(errors_of(r, l, 75.0).first, 3.0) << (offline ? "offline" : "online");
        EXPECT_LT(beyond_three_sigma(r, l, 55.0, 75.0), 0.02) << (offline ? "offline" : "online");
        // without a magnetometer nobody knows how it was turned about the vertical
        s.mekf.six_axis = true;
        EXPECT_EQ(beyond_three_sigma(run(l.imu, {}, {}, s), l, 62.0, 120.0), 0.0) << (offline ? "offline" : "online");
    }
}

TEST(AhrsSamples, AHeadingThatTheGyroAloneHoldsIsAsUncertainAsItsBias) {
    // turning about the vertical only: nothing shows the bias of that axis
    int beyond = 0, logs = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        math::Random random(seed, "bias");
        RunSettings s;
        s.mekf.six_axis = true;
        const double bias = s.mekf.tilt.bias_std * random.normal();
        Log l;
        for (double t = 0.01; t < 60.0; t += 0.01) {
            const double heading = 0.8 * std::sin(0.3 * t), rate = 0.24 * std::cos(0.3 * t);
            l.imu.push_back({Time::from_seconds(t), Vector3d(0.0, 0.0, rate + bias) + 1e-3 * random.normal3(),
                             Vector3d(0.0, 0.0, -9.81) + 0.05 * random.normal3()});
            l.truth.push_back({t, {}, {}, {}, math::quaternion_from_rpy({0.0, 0.0, heading})});
        }
        for (const bool offline : {false, true}) {
            s.offline = offline;
            beyond += beyond_three_sigma(run(l.imu, {}, {}, s), l, 30.0, 60.0) > 0.0 ? 1 : 0;
            ++logs;
        }
    }
    EXPECT_LE(beyond, 2) << "of " << logs;
}

TEST(AhrsSamples, BeforeTheFirstFieldTheOfflineHeadingIsTheGyrosBackwards) {
    Motion m;
    m.gyro_bias = Vector3d(0.2, -0.1, 0.3) * units::deg_per_s;
    Log l = log_of(m, 23);
    std::erase_if(l.mag, [](const MagSample& s) { return s.time < Time::from_seconds(40.0); });
    RunSettings s;
    s.offline = true;
    const RunResult r = run(l.imu, l.mag, {}, s);
    EXPECT_LT(beyond_three_sigma(r, l, 0.0, 40.0), 0.02);
    EXPECT_LT(errors_of(r, l, 35.0).first, 5.0);
}

TEST(AhrsCentripetal, ASteadyTurnDoesNotBankTheHorizon) {
    // 20 m/s in a level circle at 0.2 rad/s: 4 m/s^2 to the right, for two minutes
    const double dt = 0.01, speed = 20.0, rate = 0.2;
    const auto largest_roll = [&](bool aided) {
        Mekf filter{MekfSettings{}};
        math::Random noise(2, "gyro");
        double largest = 0.0;
        for (int i = 1; i <= 12000; ++i) {
            const bool turning = i > 1000;
            if (aided && i % 20 == 0) filter.forward_speed(speed, 0.1);
            filter.step(dt, Vector3d(0.0, 0.0, turning ? rate : 0.0) + 1e-3 * noise.normal3(),
                        {0.0, turning ? rate * speed : 0.0, -9.81 + 1e-4 * (i % 7)});
            largest = std::max(largest, std::abs(math::rpy_from_quaternion(filter.q_nb()).x()));
        }
        return largest / units::deg;
    };
    EXPECT_LT(largest_roll(true), 1.0);
    EXPECT_GT(largest_roll(false), 1.5 * largest_roll(true));
}

/// Final difference of heading between a run with a field that changed at 20 s for good and one without; and magnets found.
std::pair<double, std::size_t> after_a_lasting_change(const Vector3d& iron, bool place, double place_std) {
    Motion m;
    const Log clean = log_of(m, 11);
    if (place) {
        m.disturbed_from = 20.0;
        m.disturbed_to = 1e9;
    }
    Log changed = log_of(m, 11);
    for (std::size_t i = 2000; i < changed.mag.size(); ++i) changed.mag[i].field_b += iron;
    RunSettings s;
    s.mekf.heading.place_std = place_std;
    const RunResult a = run(clean.imu, clean.mag, {}, s), b = run(changed.imu, changed.mag, {}, s);
    return {a.rows.back().q_nb.angularDistance(b.rows.back().q_nb) / units::deg, b.counters.magnets};
}

TEST(AhrsRecovery, ANewPlaceDoesNotTurnTheHeadingAMagnetIsFound) {
    // the horizontal field turned by 20 deg for good: a place that adds to the field, not a sensor that has turned
    const double usual = MekfSettings{}.heading.place_std;
    EXPECT_LT(after_a_lasting_change(Vector3d::Zero(), true, usual).first, 3.0);
    const auto magnet = after_a_lasting_change(Vector3d(60e-6, -50e-6, 80e-6), false, usual);
    EXPECT_EQ(magnet.second, 1u);
    EXPECT_LT(magnet.first, 3.0);
}

TEST(AhrsRecovery, ANewPlaceIsTakenOverFromTheThirdOpinion) {
    Motion m;
    m.duration = 300.0;
    const Log clean = log_of(m, 31);
    m.disturbed_from = 150.0;
    m.turn = 70.0 * units::deg;
    const Log changed = log_of(m, 31);
    const RunResult a = run(clean.imu, clean.mag, {}, {}), b = run(changed.imu, changed.mag, {}, {});
    EXPECT_EQ(a.counters.recoveries + a.counters.magnets, 0U);
    EXPECT_EQ(b.counters.recoveries, 1U);
    EXPECT_EQ(b.counters.magnets, 0U);
    EXPECT_LT(a.rows.back().q_nb.angularDistance(b.rows.back().q_nb) / units::deg, 4.0);
    EXPECT_LT(beyond_three_sigma(b, changed, 150.0, 300.0), 0.02);
}

TEST(AhrsRecovery, WhatNothingTellsApartIsLeftOpen) {
    // the sensor lies still while the field changes for good, and turns four minutes later
    for (const bool magnet : {false, true}) {
        Motion m;
        m.duration = 520.0;
        m.rest = 400.0;
        if (!magnet) {
            m.disturbed_from = 150.0;
            m.turn = 70.0 * units::deg;
        }
        Log l = log_of(m, 32);
        for (MagSample& s : l.mag)
            if (magnet && s.time.seconds() >= 150.0) s.field_b += Vector3d(-15e-6, 14e-6, 9e-6);
        Log still = l;
        std::erase_if(still.imu, [](const ImuSample& s) { return s.time.seconds() > 400.0; });
        std::erase_if(still.mag, [](const MagSample& s) { return s.time.seconds() > 400.0; });
        const RunResult before = run(still.imu, still.mag, {}, {});
        EXPECT_EQ(before.counters.recoveries, 1U) << (magnet ? "magnet" : "place") << ": it is concluded while it lies still";
        EXPECT_EQ(before.counters.magnets, 0U);
        const RunResult all = run(l.imu, l.mag, {}, {});
        EXPECT_LT(beyond_three_sigma(all, l, 150.0, 520.0), 0.02) << (magnet ? "magnet" : "place");
    }
}

TEST(AhrsRecovery, AMagnetFromTheFirstSampleIsFoundAsSoonAsTheSensorTurns) {
    for (const bool offline : {false, true}) {
        for (const double size : {10e-6, 40e-6, 160e-6}) {
            math::Random random(21, "magnet");
            Motion m;
            m.hard_iron = size * random.normal3().normalized();
            const Log l = log_of(m, 17);
            RunSettings s;
            s.offline = offline;
            const RunResult r = run(l.imu, l.mag, {}, s);
            EXPECT_LT(errors_of(r, l, 40.0).first, 4.0) << size << (offline ? " offline" : "");
        }
    }
}

TEST(AhrsHeading, TheGyrosScaleIsLearntAndHoldsTheHeadingThroughADisturbance) {
    // it spins, now slower, now faster; from 90 to 150 s a magnet outweighs the field, it spins the other way, and nothing but the gyro
    // is left. To a filter without scale factors the spin of before has shown a bias, which is now of the wrong sign
    const double dt = 0.01;
    const Eigen::Matrix3d wrong = (Eigen::Matrix3d() << 4e-3, 2e-3, 0.0, -1e-3, 5e-3, 1e-3, 2e-3, 0.0, 6e-3).finished();
    const auto attitude = [](double t) {
        const double yaw = 0.8 * std::max(0.0, t - 5.0) + 2.0 * std::sin(0.3 * t) - 2.5 * std::max(0.0, t - 90.0);
        return math::quaternion_from_rpy({0.5 * std::sin(0.7 * t), 0.4 * std::sin(0.5 * t), yaw});
    };
    math::Random noise(14, "spin");
    Log l;
    for (double t = dt; t < 180.0; t += dt) {
        const Eigen::Quaterniond q = attitude(t);
        const Vector3d rate = math::rotation_vector_from_quaternion(attitude(t - dt).conjugate() * q) / dt;
        const bool magnet = t > 90.0 && t < 150.0;
        const Vector3d field =
            q.conjugate() * Vector3d(19e-6, 0.0, 46e-6) + (magnet ? Vector3d(90e-6, -70e-6, 60e-6) : Vector3d::Zero());
        l.imu.push_back({Time::from_seconds(t), rate + wrong * rate + 1e-3 * noise.normal3(),
                         q.conjugate() * Vector3d(0.0, 0.0, -9.81) + 0.05 * noise.normal3()});
        l.mag.push_back({Time::from_seconds(t), field + 3e-7 * noise.normal3()});
        l.truth.push_back({t, {}, {}, {}, q});
    }
    const auto rms = [&](double gyro_matrix_std, bool offline) {
        RunSettings s;
        s.offline = offline;
        s.mekf.heading.gyro_matrix_std = gyro_matrix_std;
        s.mekf.heading.field_noise = 1e-6;  // the simulated field has no places
        s.mekf.heading.field_time = 0.1;
        return errors_of(run(l.imu, l.mag, {}, s), l, 30.0).second;
    };
    const double learnt = MekfSettings{}.heading.gyro_matrix_std, online = rms(learnt, false), offline = rms(learnt, true);
    EXPECT_LT(online, 0.4 * rms(1e-7, false));
    EXPECT_LT(offline, 0.4 * rms(1e-7, true));
    EXPECT_LT(offline, online);
}

TEST(AhrsOffline, SamplesWeighByWhatTheSmoothedStatesLeaveOfThem) {
    // magnets of the middle third: the solution without them is to come out, and none worse than half a degree off it
    Motion m;
    m.gyro_bias = Vector3d(0.1, -0.1, 0.2) * units::deg_per_s;
    const Log clean = log_of(m, 15);
    Log magnet = clean;
    for (std::size_t i = 4000; i < 8000; ++i) magnet.mag[i].field_b += Vector3d(6e-6, 9e-6, -7e-6);
    RunSettings s;
    s.offline = true;
    const RunResult a = run(clean.imu, clean.mag, {}, s), b = run(magnet.imu, magnet.mag, {}, s);
    double largest = 0.0;
    for (std::size_t i = 0; i < a.rows.size(); ++i)
        largest = std::max(largest, a.rows[i].q_nb.angularDistance(b.rows[i].q_nb) / units::deg);
    EXPECT_LT(largest, 1.0);
}

TEST(AhrsRun, ThePrintedQuaternionFilterIsAFilterOfItsOwn) {
    // a magnetic disturbance tilts it a little, the corrected one not at all, the coupled one much
    Motion m;
    const Log clean = log_of(m, 12);
    m.disturbed_from = 40.0;
    m.disturbed_to = 80.0;
    const Log disturbed = log_of(m, 12);
    const auto tilt = [&](FilterKind kind) {
        RunSettings s;
        s.filter = kind;
        const RunResult a = run(clean.imu, clean.mag, {}, s), b = run(disturbed.imu, disturbed.mag, {}, s);
        double largest = 0.0;
        for (std::size_t i = 0; i < a.rows.size(); ++i) {
            const Vector3d up_a = a.rows[i].q_nb.conjugate() * Vector3d::UnitZ(),
                           up_b = b.rows[i].q_nb.conjugate() * Vector3d::UnitZ();
            largest = std::max(largest, (up_a - up_b).norm() / units::deg);
        }
        return largest;
    };
    const double projected = tilt(FilterKind::Quaternion), printed = tilt(FilterKind::QuaternionPrinted),
                 coupled = tilt(FilterKind::QuaternionCoupled);
    EXPECT_LT(projected, 1e-2);
    EXPECT_GT(printed, 3.0 * projected);
    EXPECT_GT(coupled, 2.0 * printed);
}

TEST(AhrsSettings, UnusableOnesAreNamed) {
    MekfSettings s;
    s.heading.field_noise = 0.0;
    EXPECT_THROW(Mekf{s}, Error);
    EXPECT_THROW((void)run({}, {}, {}, {}), Error);
}

// Shorter than what counts as an unknown rotation, longer than what one rate tells: dropped packets of a hand that turns.
TEST(AhrsSamples, AGapOfSomeTenthsOfASecondIsInterpolatedAndCovered) {
    for (const double length : {0.1, 0.3, 0.45}) {
        Motion m;
        m.swing = 4.0;
        Log l = log_of(m, 8);
        const auto lost = [&](double t) {
            return std::ranges::any_of(std::array{41.3, 53.1, 66.0, 78.6, 90.2},
                                       [&](double at) { return t > at && t < at + length; });
        };
        std::erase_if(l.imu, [&](const ImuSample& s) { return lost(s.time.seconds()); });
        std::erase_if(l.truth, [&](const Instant& i) { return lost(i.time); });
        for (const bool offline : {false, true}) {
            RunSettings s;
            s.offline = offline;
            const RunResult r = run(l.imu, l.mag, {}, s);
            EXPECT_EQ(r.counters.gaps, 5u) << length;
            EXPECT_LT(beyond_three_sigma(r, l, 20.0, 120.0), 0.01) << length << offline;
            EXPECT_LT(errors_of(r, l, 20.0).second, 3.0) << length << offline;
        }
    }
}

// A logger's first stamps are odd, and those of a phone come in bursts of four: neither is a gap.
TEST(AhrsSamples, OddStampsAreNoGaps) {
    Log l = log_of({}, 11);
    l.imu[0].time = l.imu[1].time - Duration::from_seconds(1e-4);
    EXPECT_EQ(run(l.imu, l.mag, {}, {}).counters.gaps, 0u);
    for (std::size_t i = 0; i < l.imu.size(); ++i)
        l.imu[i].time = Time::from_seconds(0.04 * static_cast<double>(i / 4) + 0.003 * static_cast<double>(i % 4));
    EXPECT_EQ(run(l.imu, l.mag, {}, {}).counters.gaps, 0u);
    RunSettings dcm;
    dcm.filter = FilterKind::Dcm;
    EXPECT_EQ(run(l.imu, l.mag, {}, dcm).counters.gaps, 0u);
}

// Five degrees a second at rest, as cheap gyros have it: no rotation, since neither gravity nor the field turns.
TEST(AhrsSamples, AGyroBiasOfSomeDegreesASecondIsTakenOffAtRest) {
    Motion m;
    m.gyro_bias = Vector3d(2.0, -3.0, 4.0) * units::deg_per_s;
    const Log l = log_of(m, 9);
    for (const bool offline : {false, true}) {
        RunSettings s;
        s.offline = offline;
        const RunResult r = run(l.imu, l.mag, {}, s);
        EXPECT_NEAR((r.resting_rate - m.gyro_bias).norm() / units::deg_per_s, 0.0, 0.1);
        EXPECT_NEAR((r.rows.back().gyro_bias - m.gyro_bias).norm() / units::deg_per_s, 0.0, 0.1);
        EXPECT_LT(errors_of(r, l, 20.0).first, 3.0) << offline;
    }
    EXPECT_TRUE(run(l.imu, {}, {}, {}).resting_rate.isZero()) << "gravity alone does not tell a bias from a steady turn";
    // about the vertical alone: a turntable unless the field stands still
    Motion spun;
    spun.moving = false;
    spun.gyro_bias = Vector3d(0.0, 0.0, 6.0) * units::deg_per_s;
    Log table = log_of(spun, 10);
    EXPECT_FALSE(run(table.imu, table.mag, {}, {}).resting_rate.isZero());
    EXPECT_TRUE(run(table.imu, {}, {}, {}).resting_rate.isZero());
    for (MagSample& s : table.mag)
        s.field_b = Eigen::AngleAxisd(-spun.gyro_bias.z() * s.time.seconds(), Vector3d::UnitZ()) * s.field_b;
    EXPECT_TRUE(run(table.imu, table.mag, {}, {}).resting_rate.isZero());
}

}  // namespace
}  // namespace schuler::ahrs
