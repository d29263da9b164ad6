// Shared Earth terms, gravity in Earth-fixed axes, and small displacements.
#include "schuler/earth/earth.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>
#include <GeographicLib/NormalGravity.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace {

using namespace schuler;
using namespace schuler::earth;
using units::deg;

constexpr GravityModel all_models[] = {GravityModel::Somigliana, GravityModel::Grs80, GravityModel::KfGins, GravityModel::PaperA,
                                       GravityModel::PaperC};

TEST(EarthTerms, HandFormulas) {
    const Earth earth;
    const Geodetic p{50 * deg, 0.3, 3000.0};
    const EarthTerms t = terms_at(earth, p, {-120.0, 150.0, -8.0});
    EXPECT_NEAR(t.rn, 6390702.04419 + 3000.0, 1e-5);
    EXPECT_NEAR(t.rm, 6372955.92574 + 3000.0, 1e-5);
    EXPECT_DOUBLE_EQ(t.sin_lat, std::sin(p.lat));
    EXPECT_DOUBLE_EQ(t.cos_lat, std::cos(p.lat));
    EXPECT_NEAR(t.tan_lat, std::tan(p.lat), 1e-15);
    EXPECT_NEAR(t.w_ie_n.norm(), 7.292115e-5, 1e-19);
    EXPECT_NEAR(t.w_ie_n.z(), -7.292115e-5 * std::sin(p.lat), 1e-19);
    EXPECT_EQ(t.w_ie_n.y(), 0.0);
    // Paper A's reference matrix: w_E, w_N, w_h of local level against inertial space (reference state of math.md 2.3).
    const Eigen::Vector3d w_in = t.w_ie_n + t.w_en_n;
    EXPECT_NEAR(w_in.y(), 1.8820707263e-05, 1e-15);
    EXPECT_NEAR(w_in.x(), 7.03333982255e-05, 1e-15);
    EXPECT_NEAR(w_in.z(), -8.38200800146e-05, 1e-15);
    EXPECT_NEAR(t.g_n.z(), 9.801453121395, 1e-11);
}

TEST(EarthTerms, TransportRateIsTheRotationOfLocalLevel) {
    // Moving along v for dt turns C_en by w_en: d(C_en)/dt = C_en [w_en x].
    std::mt19937_64 rng(3);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int i = 0; i < 50; ++i) {
        const Earth earth{i % 2 == 0 ? wgs84 : international1924, GravityModel::Somigliana};
        const Geodetic p{1.4 * u(rng), 3.1 * u(rng), 1e4 * u(rng)};
        const Eigen::Vector3d v{300 * u(rng), 300 * u(rng), 20 * u(rng)};
        const double dt = 0.5;
        const Geodetic after = moved_by_ned(earth, p, dt * v), before = moved_by_ned(earth, p, -dt * v);
        const Eigen::Matrix3d rate = (C_en(after.lat, after.lon) - C_en(before.lat, before.lon)) / (2 * dt);
        const Eigen::Matrix3d turn = C_en(p.lat, p.lon).transpose() * rate;
        const Eigen::Vector3d w(turn(2, 1), turn(0, 2), turn(1, 0));
        const EarthTerms t = terms_at(earth, p, v);
        EXPECT_LT((w - t.w_en_n).norm(), 1e-8 * t.w_en_n.norm() + 1e-15) << p.lat;
    }
}

TEST(EarthTerms, GravityInEarthFixedAxesIsTheSameVector) {
    std::mt19937_64 rng(4);
    std::uniform_real_distribution<double> u(-1, 1);
    for (const GravityModel model : all_models)
        for (const Ellipsoid& ellipsoid : {wgs84, krasovsky, paper_c})
            for (int i = 0; i < 50; ++i) {
                const Earth earth{ellipsoid, model};
                const Geodetic p{1.57 * u(rng), std::numbers::pi * u(rng), 1e4 + 1e4 * u(rng)};
                const Eigen::Vector3d g_n = terms_at(earth, p, Eigen::Vector3d::Zero()).g_n;
                const Eigen::Vector3d g_e = gravity_ecef(earth, ecef_from_geodetic(ellipsoid, p));
                EXPECT_LT((g_e - C_en(p.lat, p.lon) * g_n).norm(), 2e-14) << name_of(model);
                EXPECT_EQ(g_n.y(), 0.0);
                EXPECT_EQ(g_n.z(), gravity_down(model, p.lat, p.h));
            }
}

TEST(EarthTerms, EarthFixedGravityAgainstTheClosedFormPolesIncluded) {
    const GeographicLib::NormalGravity& oracle = GeographicLib::NormalGravity::WGS84();
    for (const double lat : {-90.0, -45.0, 0.0, 20.0, 89.999999, 90.0})
        for (const double lon : {-180.0, -100.0, 0.0, 45.0})
            for (const double h : {-500.0, 0.0, 20000.0}) {
                const Ecef r = ecef_from_geodetic(wgs84, {lat * deg, lon * deg, h});
                Eigen::Vector3d exact;
                oracle.U(r.r.x(), r.r.y(), r.r.z(), exact.x(), exact.y(), exact.z());
                EXPECT_LT((gravity_ecef(Earth{}, r) - exact).norm(), 1.5e-6) << lat << " " << lon << " " << h;
            }
    const Eigen::Vector3d on_axis = gravity_ecef(Earth{}, {{0.0, 0.0, wgs84.b()}});
    EXPECT_NEAR(on_axis.z(), -9.8321849379, 1e-9);
    EXPECT_LT(on_axis.head<2>().norm(), 1e-15);
}

TEST(Displacement, MovedByIsTheInverseOfDifference) {
    std::mt19937_64 rng(5);
    std::uniform_real_distribution<double> u(-1, 1);
    const Earth earth;
    for (int i = 0; i < 1000; ++i) {
        const double side = u(rng), off = u(rng);
        const double lon = i % 3 == 0 ? std::copysign(std::numbers::pi - 1e-6 * std::abs(off), side) : 3.0 * side;
        const Geodetic from{1.5 * u(rng), lon, 2e4 * u(rng)};
        const Eigen::Vector3d ned{5000 * u(rng), 5000 * u(rng), 500 * u(rng)};
        const Geodetic to = moved_by_ned(earth, from, ned);
        EXPECT_LE(std::abs(to.lon), std::numbers::pi);
        EXPECT_LT((ned_difference(earth, to, from) - ned).norm(), 1e-8);
    }
}

TEST(Displacement, AgreesWithCartesianNearby) {
    const Earth earth;
    for (const double lon : {20 * deg, std::numbers::pi - 1e-6}) {
        const Geodetic from{45 * deg, lon, 100.0};
        const Eigen::Vector3d ned(50.0, -60.0, 7.0);
        for (const double sign : {1.0, -1.0}) {
            const Geodetic to = moved_by_ned(earth, from, sign * ned);
            const Eigen::Vector3d chord =
                C_en(from.lat, from.lon).transpose() * (ecef_from_geodetic(wgs84, to).r - ecef_from_geodetic(wgs84, from).r);
            EXPECT_LT((chord - sign * ned).norm(), 1e-3);
        }
    }
}

TEST(EarthTerms, MetresNearThePolesAreThoseOfTheChord) {
    const Geodetic near_pole{89.9999 * units::deg, 40.0 * units::deg, 100.0};
    const Geodetic beyond{89.9999 * units::deg, -140.0 * units::deg, 103.0};
    // 11.17 m from the pole on either side of it: straight over it lies the other one, to the north.
    const Eigen::Vector3d over = ned_difference({}, beyond, near_pole);
    EXPECT_NEAR(over.x(), 22.34, 0.01);
    EXPECT_NEAR(over.y(), 0.0, 1e-6);
    EXPECT_NEAR(over.z(), -3.0, 1e-9);
    for (const double lat : {90.0, 89.99, -89.5, -90.0}) {
        const Geodetic from{lat * units::deg, 1.0, 50.0};
        const Eigen::Vector3d ned(300.0, -2000.0, 12.0);
        EXPECT_LT((ned_difference({}, moved_by_ned({}, from, ned), from) - ned).norm(), 1e-6) << lat;
    }
}

}  // namespace
