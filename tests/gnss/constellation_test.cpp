// Nominal constellations against their definition, the choice of satellites, and ranges to ground stations against traced rays.
#include "schuler/gnss/constellation.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/ground_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::gnss {
namespace {

using units::deg;
const Time start = Time::from_gps(2300, 3 * 86'400.0);

/// Slot B2 by hand: circular motion since the week began, seen from the turned Earth.
TEST(Constellation, GpsSlotsMoveOnCircles) {
    const BroadcastSource source(nominal_gps(start, start + Duration::from_seconds(6 * 3600.0)));
    for (const double t : {0.0, 3599.0, 9000.0, 20'000.0}) {
        const double since = 3 * 86'400.0 + t, a = 26'559'710.0;
        const double u = 173.336 * deg + std::sqrt(3.986005e14 / (a * a * a)) * since;
        const double node = (332.847 - 277.85) * deg - 7.2921151467e-5 * since, i = 55.0 * deg;
        const Eigen::Vector3d expected =
            a * Eigen::Vector3d(std::cos(node) * std::cos(u) - std::sin(node) * std::cos(i) * std::sin(u),
                                std::sin(node) * std::cos(u) + std::cos(node) * std::cos(i) * std::sin(u),
                                std::sin(i) * std::sin(u));
        const auto found = source.at({System::Gps, 6}, {}, start + Duration::from_seconds(t));
        ASSERT_TRUE(found);
        EXPECT_LT((found->state.position.r - expected).norm(), 1e-3) << t;
    }
}

TEST(Constellation, GlonassEphemeridesContinueEachOther) {
    const Navigation navigation = nominal_glonass(start, start + Duration::from_seconds(7200.0));
    int joints = 0;
    for (const GlonassEphemeris& a : navigation.glonass)
        for (const GlonassEphemeris& b : navigation.glonass) {
            if (a.satellite != b.satellite || (b.toe - a.toe).seconds() != 1800.0) continue;
            const Time middle = a.toe + Duration::from_seconds(900.0);
            EXPECT_LT((satellite_state(a, middle).position.r - satellite_state(b, middle).position.r).norm(), 1e-2);
            ++joints;
        }
    EXPECT_GE(joints, 24 * 4);
    for (const GlonassEphemeris& g : navigation.glonass) EXPECT_NEAR(g.position.norm(), 25'508e3, 30e3);
}

TEST(Constellation, BestFourHasTheLeastPdop) {
    const Navigation navigation = nominal_gps(start, start);
    const BroadcastSource source(navigation);
    const Ecef place = earth::ecef_from_geodetic(earth::wgs84, {52.3 * deg, 104.3 * deg, 10'000.0});
    const auto seen = satellites_in_view(source, satellites_of(navigation), start, place, 7.5 * deg);
    ASSERT_GE(seen.size(), 6U);
    for (std::size_t i = 1; i < seen.size(); ++i) EXPECT_GE(seen[i - 1].elevation, seen[i].elevation);
    const auto best = best_four(seen);
    std::vector<Sighting> four;
    for (const std::size_t i : best) four.push_back(seen[i]);
    const double least = pdop(four);
    EXPECT_GT(least, 1.5);
    for (std::size_t out = 0; out < 4; ++out)
        for (const Sighting& other : seen) {
            std::vector<Sighting> changed = four;
            changed[out] = other;
            EXPECT_GE(pdop(changed), least);
        }
    EXPECT_TRUE(std::isinf(pdop(std::span(four).first(3))));
}

/// Rays traced through spherical layers (reference values of math.md 5.7).
TEST(GroundRange, AgreesWithTracedRays) {
    const struct {
        double ground, h1, h2, traced;
        // clang-format off
    } rows[] = {{20e3, 200, 1e3, 5.8178},   {20e3, 200, 10e3, 3.7756},   {50e3, 200, 3e3, 12.8193},   {100e3, 200, 1e3, 29.5034},
                {100e3, 200, 10e3, 17.3002}, {150e3, 200, 3e3, 39.6343}, {200e3, 200, 3e3, 54.3149}, {200e3, 200, 10e3, 36.1767}};
    // clang-format on
    constexpr double radius = 6'371'000.0;
    for (const auto& row : rows) {
        const double a = radius + row.h1, b = radius + row.h2, angle = row.ground / radius;
        const double chord = std::sqrt(a * a + b * b - 2.0 * a * b * std::cos(angle));
        EXPECT_NEAR(ground_range_delay({0, 0, row.h1}, {0, 0, row.h2}, chord), row.traced, 0.006) << row.ground << " " << row.h2;
    }
}

}  // namespace
}  // namespace schuler::gnss
