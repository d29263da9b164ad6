// Coordinates against GeographicLib and against 80-bit arithmetic; radii against hand formulas.
#include "schuler/earth/ellipsoid.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>
#include <GeographicLib/Geocentric.hpp>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace {

using namespace schuler;
using namespace schuler::earth;
using units::deg;

struct Wide {
    long double x, y, z;
};

Wide forward_wide(const Ellipsoid& e, long double lat, long double lon, long double h) {
    const long double f = e.f, e2 = f * (2 - f);
    const long double s = std::sin(lat), c = std::cos(lat);
    const long double n = e.a / std::sqrt(1 - e2 * s * s);
    return {(n + h) * c * std::cos(lon), (n + h) * c * std::sin(lon), (n * (1 - e2) + h) * s};
}

// Newton's method on the meridian plane, from the tested answer: independent of Bowring's iteration, exact to 1e-18.
struct Meridian {
    long double lat, h;
};
Meridian refined(const Ellipsoid& e, const Ecef& r, const Geodetic& start) {
    const long double f = e.f, e2 = f * (2 - f);
    const long double p = std::hypot(static_cast<long double>(r.r.x()), static_cast<long double>(r.r.y())), z = r.r.z();
    long double lat = start.lat, h = start.h;
    for (int i = 0; i < 6; ++i) {
        const long double s = std::sin(lat), c = std::cos(lat), w2 = 1 - e2 * s * s;
        const long double n = e.a / std::sqrt(w2), m = n * (1 - e2) / w2;
        const long double dp = p - (n + h) * c, dz = z - (n * (1 - e2) + h) * s;
        lat += (-dp * s + dz * c) / (m + h);
        h += dp * c + dz * s;
    }
    return {lat, h};
}

const std::vector<double> latitudes{-90, -89.9999999, -72.5, -45, -1e-9, 0, 1e-7, 30, 45, 60, 89.999, 90};
const std::vector<double> longitudes{-180, -179.9999999, -90, 0, 12.5, 90, 135, 179.9999999, 180};
const std::vector<double> heights{-12000, -500, 0, 0.001, 8848, 30000, 4e5, 2.02e7, 3.6e7, 5e7};

TEST(Ellipsoid, EarthFixedFromGeodeticIsExactToRounding) {
    for (const Ellipsoid& e : {wgs84, pz90, krasovsky, international1924}) {
        const GeographicLib::Geocentric oracle(e.a, e.f);
        for (const double lat : latitudes)
            for (const double lon : longitudes)
                for (const double h : heights) {
                    const Ecef r = ecef_from_geodetic(e, {lat * deg, lon * deg, h});
                    const Wide w = forward_wide(e, lat * deg, lon * deg, h);
                    const double bound = h < 1e5 ? 2e-9 : 3e-16 * (e.a + h);
                    EXPECT_NEAR(static_cast<double>(r.r.x() - w.x), 0.0, bound) << lat << " " << lon << " " << h;
                    EXPECT_NEAR(static_cast<double>(r.r.y() - w.y), 0.0, bound) << lat << " " << lon << " " << h;
                    EXPECT_NEAR(static_cast<double>(r.r.z() - w.z), 0.0, bound) << lat << " " << lon << " " << h;
                    double x, y, z;
                    oracle.Forward(lat, lon, h, x, y, z);
                    EXPECT_LT((r.r - Eigen::Vector3d(x, y, z)).norm(), 1e-8 + 4e-16 * h);
                }
    }
}

void expect_reverse(const Ellipsoid& e, const Ecef& r, const Geodetic& g) {
    const Meridian exact = refined(e, r, g);
    EXPECT_NEAR(static_cast<double>(g.lat - exact.lat), 0.0, 1e-15) << g.lat << " " << g.h;
    EXPECT_NEAR(static_cast<double>(g.h - exact.h), 0.0, g.h < 1e5 ? 3e-9 : 5e-16 * (e.a + g.h)) << g.lat << " " << g.h;
}

TEST(Ellipsoid, GeodeticFromEarthFixedAtPolesEquatorDateLineAndSatelliteHeight) {
    const GeographicLib::Geocentric oracle(wgs84.a, wgs84.f);
    for (const double lat : latitudes)
        for (const double lon : longitudes)
            for (const double h : heights) {
                Ecef r;
                oracle.Forward(lat, lon, h, r.r.x(), r.r.y(), r.r.z());
                const Geodetic g = geodetic_from_ecef(wgs84, r);
                expect_reverse(wgs84, r, g);
                EXPECT_NEAR(g.lat, lat * deg, 2e-15);
                EXPECT_NEAR(g.h, h, 2e-8);
                if (std::abs(lat) < 89.99) {
                    EXPECT_NEAR(std::remainder(g.lon - lon * deg, 2 * std::numbers::pi), 0.0, 1e-15);
                }
            }
}

TEST(Ellipsoid, GeodeticFromEarthFixedAtRandomPlaces) {
    std::mt19937_64 rng(11);
    std::uniform_real_distribution<double> z(-1, 1), lon(-180, 180), level(0, 1);
    for (int i = 0; i < 20000; ++i) {
        const double h = -12000 + 5.0012e7 * std::pow(level(rng), 4);
        for (const Ellipsoid& e : {wgs84, krasovsky, paper_c}) {
            const Ecef r = ecef_from_geodetic(e, {std::asin(z(rng)), lon(rng) * deg, h});
            expect_reverse(e, r, geodetic_from_ecef(e, r));
        }
    }
}

TEST(Ellipsoid, OnTheAxisTheLongitudeIsDefined) {
    const Geodetic north = geodetic_from_ecef(wgs84, {{0.0, 0.0, wgs84.b() + 10.0}});
    EXPECT_DOUBLE_EQ(north.lat, std::numbers::pi / 2);
    EXPECT_EQ(north.lon, 0.0);
    EXPECT_NEAR(north.h, 10.0, 3e-9);
    const Geodetic south = geodetic_from_ecef(wgs84, {{0.0, 0.0, -wgs84.b()}});
    EXPECT_DOUBLE_EQ(south.lat, -std::numbers::pi / 2);
    EXPECT_NEAR(south.h, 0.0, 3e-9);
}

TEST(Ellipsoid, RadiiAtEquatorPoleAndPaperASample) {
    const Radii equator = radii(wgs84, 0.0);
    EXPECT_NEAR(equator.prime_vertical, wgs84.a, 1e-9);
    EXPECT_NEAR(equator.meridian, wgs84.b() * wgs84.b() / wgs84.a, 2e-9);
    const Radii pole = radii(wgs84, std::numbers::pi / 2);
    EXPECT_NEAR(pole.meridian, wgs84.a * wgs84.a / wgs84.b(), 4e-9);
    EXPECT_NEAR(pole.prime_vertical, pole.meridian, 4e-9);
    const Radii r = radii(wgs84, 50 * deg);
    EXPECT_NEAR(r.prime_vertical, 6390702.04419, 1e-5);
    EXPECT_NEAR(r.meridian, 6372955.92574, 1e-5);
}

TEST(Ellipsoid, LocalLevelAxesAreTheDerivativesOfPosition) {
    for (const double lat : {-71.0, -3.0, 0.0, 44.0, 88.0})
        for (const double lon : {-179.0, -60.0, 0.0, 101.0}) {
            const Geodetic g{lat * deg, lon * deg, 250.0};
            const Eigen::Matrix3d C = C_en(g.lat, g.lon);
            const double d = 1e-6;
            const auto at = [&](double a, double b, double c) {
                return ecef_from_geodetic(wgs84, {g.lat + a, g.lon + b, g.h + c}).r;
            };
            const Eigen::Vector3d north = (at(d, 0, 0) - at(-d, 0, 0)).normalized();
            const Eigen::Vector3d east = (at(0, d, 0) - at(0, -d, 0)).normalized();
            const Eigen::Vector3d down = (at(0, 0, -10) - at(0, 0, 10)).normalized();
            EXPECT_LT((C.col(0) - north).norm(), 1e-8);
            EXPECT_LT((C.col(1) - east).norm(), 1e-8);
            EXPECT_LT((C.col(2) - down).norm(), 1e-8);
            EXPECT_LT((C.transpose() * C - Eigen::Matrix3d::Identity()).norm(), 1e-15);
        }
}

}  // namespace
