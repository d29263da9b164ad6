// Phase centres of antennas against geometry, and the sun against its known places.
#include "schuler/gnss/antenna.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/satellite_source.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

namespace schuler::gnss {
namespace {

using Eigen::Vector3d;

using units::deg;

Antenna antenna_with(Vector3d offset, std::vector<std::vector<double>> rows) {
    Antenna a;
    a.type = "MADE UP         NONE";
    a.carriers.push_back({l1_frequency, offset, {0.0, 45.0 * deg, std::move(rows)}});
    return a;
}

TEST(Antenna, IsReferredToItsReferencePoint) {
    const Antenna a = antenna_with({0.03, -0.05, 0.12}, {{0.0, 0.002, 0.008}});
    const Geodetic place{50.0 * deg, 30.0 * deg, 200.0};
    const Ecef point = earth::ecef_from_geodetic(earth::wgs84, place);
    const Eigen::Matrix3d C = earth::C_en(place.lat, place.lon);
    const Vector3d centre = point.r + C * Vector3d(0.03, -0.05, -0.12);
    for (const Vector3d& ned : {Vector3d(1e7, 5e6, -2e7), Vector3d(-1e7, 1.5e7, -8e6), Vector3d(0, 0, -2e7)}) {
        const Ecef satellite{point.r + C * ned};
        const Direction d = direction_to(satellite, point, place);
        // the variation is linear over each half of the quadrant
        const double zenith = 90.0 - d.elevation / deg,
                     variation = zenith < 45.0 ? 0.002 * zenith / 45.0 : 0.002 + 0.006 * (zenith - 45.0) / 45.0;
        const double measured = (satellite.r - centre).norm() + variation;
        EXPECT_NEAR(measured + a.to_reference_point(l1_frequency, d), (satellite.r - point.r).norm(), 1e-6);
    }
}

TEST(Antenna, VariesWithAzimuth) {
    const Antenna a = antenna_with(Vector3d::Zero(), {{0, 0, 0.001}, {0, 0, 0.003}, {0, 0, 0.005}, {0, 0, 0.007}, {0, 0, 0.001}});
    EXPECT_NEAR(-a.to_reference_point(l1_frequency, {0.0, 0.0}), 0.001, 1e-9);
    EXPECT_NEAR(-a.to_reference_point(l1_frequency, {135.0 * deg, 0.0}), 0.004, 1e-9);
    EXPECT_NEAR(-a.to_reference_point(l1_frequency, {-45.0 * deg, 0.0}), 0.004, 1e-9);  // 315 deg
    EXPECT_NEAR(-a.to_reference_point(l1_frequency, {-90.0 * deg, 45.0 * deg}), 0.0, 1e-9);
}

TEST(Antenna, IsFoundByItsTypeAndOtherwiseWithoutItsRadome) {
    Antennas all;
    for (const char* type : {"TRM57971.00     NONE", "TRM57971.00     SCIT", "ABC1            NONE"})
        all.receivers.push_back({type, {}});
    EXPECT_EQ(all.of_receiver("TRM57971.00     SCIT"), &all.receivers[1]);
    EXPECT_EQ(all.of_receiver("TRM57971.00     TZGD"), &all.receivers[0]);
    EXPECT_EQ(all.of_receiver("ABC1"), &all.receivers[2]);
    EXPECT_EQ(all.of_receiver("ABC2            NONE"), nullptr);
    EXPECT_EQ(all.of_receiver(""), nullptr);
}

/// Subsolar points: equinox and solstice of 2021 by the Astronomical Almanac, with the equation of time of those days.
TEST(Sun, StandsWhereTheCalendarSays) {
    const auto at = [](Calendar utc) { return direction_of_sun(gps_from_utc(utc)); };
    const Vector3d march = at({2021, 3, 20, 9, 37, 27.0}), june = at({2021, 6, 21, 3, 32, 8.0});
    EXPECT_NEAR(std::asin(march.z()) / deg, 0.0, 0.02);
    EXPECT_NEAR(std::asin(june.z()) / deg, 23.436, 0.02);
    // true solar time at Greenwich: UT minus 7 min 26 s in March, minus 1 min 49 s in June
    const auto subsolar = [](double hours) { return (12.0 - hours) * 15.0; };
    EXPECT_NEAR(std::atan2(march.y(), march.x()) / deg, subsolar(9.0 + 37.45 / 60.0 - 7.43 / 60.0), 0.1);
    EXPECT_NEAR(std::atan2(june.y(), june.x()) / deg, subsolar(3.0 + 32.13 / 60.0 - 1.82 / 60.0), 0.1);
}

TEST(SatelliteAntenna, PointsToTheEarthAndItsPanelsAcrossTheSun) {
    const Time t = gps_from_utc({2021, 3, 20, 12, 0, 0.0});
    const Ecef satellite{{1.5e7, 1.8e7, 1.2e7}};
    const Antenna a = antenna_with({0.279, 0.0, 2.5}, {});
    const Vector3d centre = satellite_phase_centre(a, l1_frequency, satellite, t), earthward = -satellite.r.normalized();
    EXPECT_NEAR(centre.dot(earthward), 2.5, 1e-12);
    const Vector3d across = centre - 2.5 * earthward;
    EXPECT_NEAR(across.norm(), 0.279, 1e-12);
    EXPECT_GT(across.dot(direction_of_sun(t)), 0.0);  // the x axis is on the sunny side
    EXPECT_NEAR(across.dot(earthward.cross(direction_of_sun(t))), 0.0, 1e-12);
}

/// Precise orbits are of centres of mass: with the antenna those of the phase centre, without it with the difference in the variance.
TEST(SatelliteAntenna, LeadsFromTheCentreOfMassOrIsInTheVariance) {
    const Time start = gps_from_utc({2021, 3, 20, 12, 0, 0.0});
    const SatelliteId g3{System::Gps, 3};
    std::vector<std::vector<PreciseSource::Node>> nodes(satellite_count);
    for (int i = 0; i < 13; ++i) {
        const double a = 0.04 * i;
        nodes[index_of(g3)].push_back({start + Duration::from_seconds(300.0 * i),
                                       26.56e6 * Vector3d(std::cos(a), 0.6 * std::sin(a), 0.8 * std::sin(a)), 0.0});
    }
    Antennas antennas;
    antennas.satellites.push_back({g3, start, start + Duration::from_seconds(86'400.0), antenna_with({0.0, 0.0, 2.5}, {})});
    const Time t = start + Duration::from_seconds(1800.0);
    const auto mass = PreciseSource(nodes).at(g3, {}, t), centre = PreciseSource(nodes, antennas).at(g3, {}, t);
    ASSERT_TRUE(mass && centre);
    EXPECT_NEAR(mass->state.position.r.norm() - centre->state.position.r.norm(), 2.5, 1e-6);
    EXPECT_LT(centre->state.variance, 0.01);
    EXPECT_GT(mass->state.variance, 1.0);
}

}  // namespace
}  // namespace schuler::gnss
