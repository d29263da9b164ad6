// Simulated ranges against a position solver that knows nothing of them, and what hides and spoils them.
#include "schuler/sim/ranging.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/constellation.h"
#include "schuler/gnss/single_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <set>

namespace schuler::sim {
namespace {

using units::deg;
const Geodetic station{52.3 * deg, 104.3 * deg, 500.0};

RangingScenario empty_scenario() { return {1, 60.0, {}, Time::from_gps(2300, 7200.0), {}}; }

RangingSettings quiet(bool glonass = true) {
    RangingSettings r;
    const RangingScenario f = empty_scenario();
    r.navigation = gnss::nominal_gps(f.gps, f.gps + Duration::from_seconds(60.0));
    if (glonass) r.navigation.add(gnss::nominal_glonass(f.gps, f.gps + Duration::from_seconds(60.0)));
    r.errors.satellite = {0.0, 0.0, 600.0, 0.0};
    r.errors.station = {0.0, 0.0, 600.0, 0.0};
    r.errors.network = 0.0;
    return r;
}

SimulatedRanges at_rest(const RangingSettings& r) {
    const auto path = make_path(StaticPath{station}, earth::wgs84);
    return simulate_ranges(empty_scenario(), *path, r);
}

std::set<std::string> seen(const RangingLog& log, double t) {
    std::set<std::string> out;
    for (const RangeEpoch& e : log.epochs)
        if (std::abs(e.time.seconds() - t) < 1e-6)
            for (const RangeSample& m : log.of(e)) out.insert(log.sources[m.source].name);
    return out;
}

/// The receiver's log of noise-free ranges, solved from its own files' content: station to a millimetre, rest to 1 mm/s.
TEST(Ranging, NoiseFreeRangesMeetAtThePlace) {
    const RangingSettings r = quiet();
    const SimulatedRanges ranges = at_rest(r);
    const gnss::ObservationLog log = observations_of(ranges.log, empty_scenario().gps - Time{});
    const gnss::BroadcastSource source(r.navigation);
    gnss::SinglePointSettings settings;
    settings.ranges.ionosphere = gnss::IonosphereModel::None;
    settings.ranges.troposphere = gnss::TroposphereModel::None;
    gnss::SinglePoint solver(source, std::nullopt, settings);
    const Ecef truth = earth::ecef_from_geodetic(earth::wgs84, station);
    ASSERT_EQ(log.epochs.size(), 60U);
    for (std::size_t k = 0; k < log.epochs.size(); k += 13) {
        const auto s = solver.solve(log.of(log.epochs[k]), log.epochs[k].time, log.channels);
        ASSERT_EQ(s.status, gnss::SinglePointStatus::Solved);
        EXPECT_GE(s.used(), 10);
        EXPECT_LT((s.position.r - truth.r).norm(), 2e-3);
        EXPECT_LT(s.velocity.norm(), 2e-3);
        EXPECT_NEAR(s.clock[0], ranges.truth[k].clock, 2e-3);
        EXPECT_NEAR(s.drift, ranges.truth[k].drift, 2e-3);
    }
}

TEST(Ranging, MasksLimitsAndBlocksHide) {
    RangingSettings r = quiet(false);
    const std::set<std::string> all = seen(at_rest(r).log, 10.0);
    ASSERT_GE(all.size(), 6U);
    r.blocked.push_back({{*all.begin()}, 5.0, 10.0});
    r.limits.push_back({30.0, 2, 3});
    r.limits.push_back({45.0, 0, 0});
    const RangingLog log = at_rest(r).log;
    EXPECT_EQ(seen(log, 4.0), all);
    EXPECT_EQ(seen(log, 5.0).count(*all.begin()), 0U);
    EXPECT_EQ(seen(log, 15.0), all);
    EXPECT_EQ(seen(log, 30.0).size(), 2U);
    EXPECT_TRUE(seen(log, 50.0).empty());
    RangingSettings walled = quiet(false);
    walled.masks.terrain = {{0.0, 89.0 * deg}, {180.0 * deg, 0.0}};  // a wall in the east
    const auto west = seen(at_rest(walled).log, 10.0);
    EXPECT_LT(west.size(), all.size());
    EXPECT_GT(west.size(), 0U);
}

TEST(Ranging, HidingOneSourceLeavesTheOthersAlone) {
    RangingSettings r = quiet(false);
    r.errors = {};
    const RangingLog log = at_rest(r).log;
    r.blocked.push_back({{log.sources[0].name}, 0.0, 1e9});
    r.faults.push_back({log.sources[1].name, 20.0, 10.0, 50.0, 2.0, 0.0});
    const RangingLog other = at_rest(r).log;
    for (std::size_t k = 0; k < log.epochs.size(); ++k) {
        const double t = log.epochs[k].time.seconds();
        for (const RangeSample& m : log.of(log.epochs[k])) {
            for (const RangeSample& n : other.of(other.epochs[k])) {
                if (log.sources[m.source].name != other.sources[n.source].name) continue;
                const bool faulty = m.source == 1 && t >= 20.0 && t < 30.0;
                EXPECT_NEAR(n.pseudorange - m.pseudorange, faulty ? 50.0 + 2.0 * (t - 20.0) : 0.0, 1e-6);
            }
        }
    }
}

TEST(Ranging, ErrorsHaveTheirStatedSizes) {
    RangingSettings r = quiet(false), noisy = r;
    noisy.errors.satellite = {1.5, 2.0, 5.0, 0.1};
    RangingSettings slow = noisy;
    slow.errors.satellite.correlated_rate = 0.3;
    slow.errors.satellite.correlated_rate_time = 3.0;
    double sum = 0.0, rate = 0.0, slow_rate = 0.0, products = 0.0, squares = 0.0;
    int n = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        RangingScenario f = empty_scenario();
        f.seed = seed;
        const auto path = make_path(StaticPath{station}, earth::wgs84);
        const RangingLog a = simulate_ranges(f, *path, r).log, b = simulate_ranges(f, *path, noisy).log;
        for (std::size_t i = 0; i < a.samples.size(); ++i, ++n) {
            sum += std::pow(b.samples[i].pseudorange - a.samples[i].pseudorange, 2);
            rate += std::pow(b.samples[i].range_rate - a.samples[i].range_rate, 2);
        }
        // the slow errors of the rates come on top and leave everything else as it is
        std::map<std::uint16_t, double> before;
        const RangingLog c = simulate_ranges(f, *path, slow).log;
        for (std::size_t i = 0; i < c.samples.size(); ++i) {
            EXPECT_EQ(c.samples[i].pseudorange, b.samples[i].pseudorange);
            const double error = c.samples[i].range_rate - b.samples[i].range_rate;
            slow_rate += error * error;
            const auto [at, first] = before.try_emplace(c.samples[i].source, error);
            if (!first) {
                products += at->second * error;
                squares += at->second * at->second;
            }
            at->second = error;
        }
    }
    EXPECT_NEAR(std::sqrt(slow_rate / n), 0.3, 0.02);
    EXPECT_NEAR(products / squares, std::exp(-1.0 / (r.rate * 3.0)), 0.03) << "from one epoch to the next";
    EXPECT_NEAR(std::sqrt(sum / n), 2.5, 0.1);
    EXPECT_NEAR(std::sqrt(rate / n), 0.1, 0.003);
}

TEST(Ranging, NamesOfSourcesThatDoNotExistAreRefused) {
    const auto path = make_path(StaticPath{station}, earth::wgs84);
    const auto refused = [&](const RangingSettings& r) {
        try {
            (void)simulate_ranges(empty_scenario(), *path, r);
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("G99"), std::string::npos);
            return e.place().key;
        }
        return std::string("nothing");
    };
    RangingSettings r = quiet();
    r.faults = {{"G99", 0.0, 10.0, 5.0}};
    EXPECT_EQ(refused(r), "ranges.fault");
    r = quiet();
    r.blocked = {{{"stations", "G99"}, 0.0, 10.0}};
    EXPECT_EQ(refused(r), "ranges.block");
    r.blocked = {{{"stations"}, 0.0, 10.0}};
    EXPECT_EQ(refused(r), "nothing");
}

}  // namespace
}  // namespace schuler::sim
