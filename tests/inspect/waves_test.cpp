// Afloat or not: simulated ships against cars, walks and flights, whose tilt is not felt or whose height is not that of the sea.
#include "schuler/inspect/detail/motion/waves.h"

#include "schuler/core/units.h"
#include "schuler/math/random.h"
#include "schuler/sensor/grades.h"
#include "schuler/sim/simulate.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

namespace schuler::inspect::detail {
namespace {

using units::deg;

Waves waves_on(const sim::PathSettings& path, std::uint64_t seed, const std::string& grade, double duration = 240.0,
               double imu_rate = 100.0) {
    sim::Scenario s;
    s.seed = seed;
    s.duration = duration;
    s.origin = Time::from_seconds(1000.0);
    s.path = path;
    s.imu.errors = sensor::imu_grade(grade);
    s.imu.rate = imu_rate;
    s.gnss.rate = 1.0;
    s.gnss.white_position = Eigen::Vector3d(1.0, 1.0, 2.0);
    const Recording r = sim::simulate(s).recording;
    return waves_of(imu_series(r.imu, s.imu.kind, s.origin), gnss_series(r.gnss, s.origin));
}

TEST(Waves, ShipsOfAnySeaAreRecognised) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        math::Random random(seed, "test.waves");
        const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(); };
        const auto wave = [&](double low, double high) {
            return sim::Wave{between(low, high), between(5.0, 12.0), between(0.0, 2.0 * std::numbers::pi)};
        };
        sim::ShipPath ship;
        ship.start = {between(-60.0, 60.0) * deg, 0.3, 0.0};
        ship.speed = between(3.0, 10.0);
        ship.roll = wave(0.5 * deg, 3.0 * deg);
        ship.pitch = wave(0.3 * deg, 3.0 * deg);
        ship.yaw = wave(0.3 * deg, 3.0 * deg);
        ship.heave = wave(0.3, 2.0);
        const Waves w = waves_on(ship, seed, seed % 2 == 0 ? "mems" : "consumer");
        EXPECT_TRUE(w.found) << "seed " << seed << ": tilt " << w.tilt / deg << " deg, share " << w.share << ", felt " << w.felt
                             << ", height " << w.height;
    }
}

TEST(Waves, CarsAndFlightsAreNone) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        sim::RoutePath town = sim::town_route({50.4 * deg, 30.5 * deg, 150.0}, 300.0, seed);
        town.vibration = {12.0, 5e-4, 0.5};
        EXPECT_FALSE(waves_on(town, seed, "mems").found) << seed;
        sim::FigureEightPath eight;  // banks at the periods of a long swell, and feels nothing of it
        eight.start = {31.7 * deg, 52.8 * deg, 300.0};
        eight.length = 100.0 * static_cast<double>(seed);
        eight.width = 0.4 * eight.length;
        eight.period = 15.0 * static_cast<double>(seed);
        const Waves w = waves_on(eight, seed, "mems");
        EXPECT_FALSE(w.found) << seed;
        EXPECT_LT(w.felt, 0.5) << seed;
    }
}

TEST(Waves, NothingIsFoundInShortOrSlowLogs) {
    EXPECT_FALSE(waves_on(sim::ShipPath{.start = {0.9, 0.5, 0.0}}, 1, "mems", 200.0, 1.0).found);
    EXPECT_FALSE(waves_on(sim::ShipPath{.start = {0.9, 0.5, 0.0}}, 1, "mems", 100.0).found);
    EXPECT_FALSE(waves_of({}, {}).found);
}

}  // namespace
}  // namespace schuler::inspect::detail
