// Simulated signals against the ranges that are simulated without them, and against free space.
#include "schuler/sim/signals.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/constellation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::sim {
namespace {

using units::deg;
const Geodetic place{52.3 * deg, 104.3 * deg, 500.0};

RangingScenario frame() { return {1, 60.0, {}, Time::from_gps(2300, 7200.0), {}}; }

SignalSettings quiet_signals() {
    SignalSettings s;
    s.ranging.navigation = gnss::nominal_gps(frame().gps, frame().gps + Duration::from_seconds(60.0));
    s.ranging.errors.satellite = {0.0, 0.0, 600.0, 0.0};
    s.ranging.errors.clock = {0.0, 0.0, 0.0, 0.0};
    return s;
}

/// 20 g in a figure of eight: range at every epoch, at instants between samples too, and its derivatives by differences.
TEST(Signals, MotionIsThatOfTheRangesAndItsDerivativesFit) {
    SignalSettings s = quiet_signals();
    FigureEightPath eight;
    eight.start = place;
    eight.length = 1000.0;
    eight.width = 400.0;
    eight.period = 12.0;
    const auto path = make_path(eight, earth::wgs84);
    s.ranging.rate = 49.0;  // not in step with the samples, and from before the first of them on
    for (gnss::KeplerEphemeris& k : s.ranging.navigation.kepler) k.af0 = 1e-6 * k.satellite.number;
    RangingScenario scenario = frame();
    scenario.duration = 12.0;
    const SimulatedRanges ranges = simulate_ranges(scenario, *path, s.ranging);
    const Signals signals(scenario, *path, s);
    int compared = 0;
    for (std::size_t i = 0; i < signals.size(); ++i) {
        for (const RangeEpoch& e : ranges.log.epochs)
            for (const RangeSample& m : ranges.log.of(e)) {
                if (ranges.log.sources[m.source].name != gnss::name_of(signals.satellite(i))) continue;
                const double t = e.time.seconds();
                // slopes at the start see one side
                EXPECT_NEAR(signals.motion(i, t).range, m.pseudorange, t < 0.1 ? 2e-3 : 1e-4) << t;
                ++compared;
            }
        for (const double t : {3.01, 7.333, 10.049}) {
            constexpr double h = 1e-4;
            const SignalMotion m = signals.motion(i, t), before = signals.motion(i, t - h), after = signals.motion(i, t + h);
            EXPECT_NEAR(m.rate, (after.range - before.range) / (2.0 * h), 1e-3);
            EXPECT_NEAR(m.acceleration, (after.rate - before.rate) / (2.0 * h), 1e-2);
            EXPECT_NEAR(m.jerk, (after.acceleration - before.acceleration) / (2.0 * h), 1e-1);
        }
    }
    EXPECT_GT(compared, 2000);
}

TEST(Signals, CodesAreDelayedByTheSlowErrors) {
    SignalSettings s = quiet_signals();
    s.ranging.errors.satellite = {0.0, 3.0, 1.0, 0.0};
    const Signals signals(frame(), *make_path(StaticPath{place}, earth::wgs84), s);
    double square = 0.0, later = 0.0, n = 0.0;
    for (std::size_t i = 0; i < signals.size(); ++i)
        for (double t = 0.0; t < 59.0; t += 0.05) {
            const double d = signals.code_delay(i, t);
            square += d * d;
            later += d * signals.code_delay(i, t + 1.0);
            n += 1.0;
            EXPECT_NEAR(signals.code_delay(i, t + 0.025), 0.5 * (d + signals.code_delay(i, t + 0.05)), 1e-4);
        }
    EXPECT_NEAR(square / n, 9.0, 1.5);
    EXPECT_NEAR(later / square, std::exp(-1.0), 0.1) << "after one correlation time";
}

TEST(Signals, RatesHaveSlowErrorsOfTheirOwn) {
    SignalSettings s = quiet_signals();
    const auto path = make_path(StaticPath{place}, earth::wgs84);
    const Signals clean(frame(), *path, s);
    EXPECT_EQ(clean.rate_error(0, 1.0), 0.0);
    s.ranging.errors.satellite.correlated_rate = 0.2;
    s.ranging.errors.satellite.correlated_rate_time = 1.0;
    const Signals signals(frame(), *path, s);
    double square = 0.0, later = 0.0, together = 0.0, n = 0.0;
    for (std::size_t i = 0; i < signals.size(); ++i)
        for (double t = 0.0; t < 58.0; t += 0.05) {
            EXPECT_EQ(signals.motion(i, t).range, clean.motion(i, t).range);
            const double e = signals.rate_error(i, t);
            square += e * e;
            later += e * signals.rate_error(i, t + 1.0);
            together += e * signals.rate_error((i + 1) % signals.size(), t);
            n += 1.0;
        }
    EXPECT_NEAR(std::sqrt(square / n), 0.2, 0.02);
    EXPECT_NEAR(later / square, std::exp(-1.0), 0.1) << "after one correlation time";
    EXPECT_NEAR(together / square, 0.0, 0.15) << "of two satellites";
}

TEST(Signals, WeakenAsFreeSpaceAndProfileSay) {
    SignalSettings s = quiet_signals();
    s.profile = {{10.0, 45.0}, {20.0, 35.0}};
    const auto path = make_path(StaticPath{place}, earth::wgs84);
    const double distance = 10e3, power = 2.0;
    Jammer j;
    j.position = place;
    j.position.h += distance;
    j.power = power;
    j.start = 30.0;
    j.duration = 10.0;
    s.jammers = {j};
    s.ranging.blocked = {{{}, 50.0, 5.0}};
    const Signals signals(frame(), *path, s);
    const auto db = [&](double t) { return 10.0 * std::log10(signals.cn0(0, t)); };
    EXPECT_NEAR(db(5.0), 45.0, 1e-4);
    EXPECT_NEAR(db(14.0), 41.0, 1e-4);
    EXPECT_NEAR(db(25.0), 35.0, 1e-4);
    // 2 W at 10 km: 3.01 dBW - 20 log10(4 pi 10 km / 19.03 cm) + 158.5 dBW
    const double js = 10.0 * std::log10(power) - 20.0 * std::log10(4.0 * std::numbers::pi * distance / 0.19029367) + 158.5;
    EXPECT_NEAR(signals.jammer_to_signal(35.0), js, 1e-3);
    EXPECT_NEAR(js, 45.114, 0.001);
    // far above the noise of 35 dB-Hz, the jammer alone decides: Q Rc / (J/S)
    const double jammed = 10.0 * std::log10(2.22 * 1.023e6) - js;
    EXPECT_NEAR(db(35.0), -10.0 * std::log10(std::pow(10.0, -3.5) + std::pow(10.0, -jammed / 10.0)), 1e-3);
    EXPECT_EQ(signals.cn0(0, 52.0), 0.0);
    EXPECT_TRUE(signals.in_view(0, 52.0));
    EXPECT_NEAR(db(56.0), 35.0, 1e-4);
}

/// What is measured of a signal, motion and code delay together, has the fault of the range; the carrier what the rate has of it.
TEST(Signals, FaultsAreThoseOfTheRanges) {
    SignalSettings s = quiet_signals();
    const auto path = make_path(StaticPath{place}, earth::wgs84);
    const SimulatedRanges healthy = simulate_ranges(frame(), *path, s.ranging);
    const Signals clean(frame(), *path, s);
    const std::string victim = gnss::name_of(clean.satellite(1));
    s.ranging.faults = {{victim, 10.0, 10.0, 50.0}, {victim, 15.0, 20.0, 0.0, 2.0, -2.0}, {victim, 40.0, 10.0, 0.0, 3.0}};
    const SimulatedRanges ranges = simulate_ranges(frame(), *path, s.ranging);
    const Signals signals(frame(), *path, s);
    ASSERT_EQ(ranges.log.samples.size(), healthy.log.samples.size());
    double largest = 0.0;
    for (std::size_t k = 0; k < ranges.log.epochs.size(); ++k)
        for (std::size_t j = 0; j < ranges.log.epochs[k].count; ++j) {
            const RangeSample &with = ranges.log.samples[ranges.log.epochs[k].first + j],
                              &without = healthy.log.samples[ranges.log.epochs[k].first + j];
            const double t = ranges.log.epochs[k].time.seconds();
            for (std::size_t i = 0; i < signals.size(); ++i) {
                if (gnss::name_of(signals.satellite(i)) != ranges.log.sources[with.source].name) continue;
                const SignalMotion faulty = signals.motion(i, t), right = clean.motion(i, t);
                EXPECT_NEAR(faulty.range + signals.code_delay(i, t) - right.range, with.pseudorange - without.pseudorange, 1e-6)
                    << t;
                EXPECT_NEAR(faulty.rate - right.rate, with.range_rate - without.range_rate, 1e-6) << t;
                largest = std::max(largest, std::abs(with.pseudorange - without.pseudorange));
            }
        }
    EXPECT_GT(largest, 50.0);
    EXPECT_NEAR(signals.motion(1, 25.0).range, clean.motion(1, 25.0).range, 1e-9)
        << "the carrier does not follow a delay of the code";
}

TEST(Signals, RefusesWhatCorrelatorsDoNotHave) {
    const auto path = make_path(StaticPath{place}, earth::wgs84);
    const auto refused = [&](const SignalSettings& s) {
        try {
            const Signals signals(frame(), *path, s);
        } catch (const Error& e) {
            return e.place().key;
        }
        return std::string("nothing");
    };
    SignalSettings s = quiet_signals();
    s.ranging.multipath.amplitude = 1.0;
    EXPECT_EQ(refused(s), "ranges.multipath_m");
    s = quiet_signals();
    s.profile = {{10.0, 45.0}, {10.0, 40.0}};
    EXPECT_EQ(refused(s), "receiver.cn0_profile");
    s = quiet_signals();
    s.jammers = {{place, 0.0}};
    EXPECT_EQ(refused(s), "receiver.jammer");
    s = quiet_signals();
    s.ranging.errors.satellite.correlation_time = 0.0;
    EXPECT_EQ(refused(s), "ranges") << "what ranges and signals share";
}

}  // namespace
}  // namespace schuler::sim
