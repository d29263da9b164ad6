// Datum transformations against hand-worked sums and published parameter sets of other editions.
#include "schuler/earth/datum.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace {

using namespace schuler;
using namespace schuler::earth;
using units::deg;

constexpr Datum all_datums[] = {Datum::Wgs84, Datum::Pz90, Datum::Pz90_11, Datum::Sk42, Datum::Ed50};
const Ecef moscow = ecef_from_geodetic(wgs84, {55.75 * deg, 37.62 * deg, 180.0});

TEST(Datum, RotationIsOfTheCoordinateFrame) {
    // A frame turned by +wz about z: a point on the x axis gets a NEGATIVE y (position-vector rotation would give +).
    const Helmert turn{{0, 0, 0}, {0, 0, 1e-6}, 0};
    const Ecef moved = transformed(turn, {{6.4e6, 0, 0}});
    EXPECT_NEAR(moved.r.y(), -6.4, 1e-9);
    const Helmert about_x{{0, 0, 0}, {1e-6, 0, 0}, 0};
    EXPECT_NEAR(transformed(about_x, {{0, 6.4e6, 0}}).r.z(), -6.4, 1e-9);
    const Helmert about_y{{0, 0, 0}, {0, 1e-6, 0}, 0};
    EXPECT_NEAR(transformed(about_y, {{6.4e6, 0, 0}}).r.z(), 6.4, 1e-9);
    const Helmert scaled{{1, 2, 3}, {0, 0, 0}, 1e-6};
    EXPECT_LT((transformed(scaled, {{1e6, 2e6, -1e6}}).r - Eigen::Vector3d(1000002, 2000004, -999998)).norm(), 1e-8);
}

TEST(Datum, InverseIsExact) {
    for (const Helmert* p : {&pz90_to_pz90_11(), &sk42_to_pz90_11(), &wgs84_to_pz90_11(), &ed50_to_wgs84()}) {
        EXPECT_LT((transformed_back(*p, transformed(*p, moscow)).r - moscow.r).norm(), 3e-9);
        EXPECT_LT((transformed(*p, transformed_back(*p, moscow)).r - moscow.r).norm(), 3e-9);
    }
    for (const Datum from : all_datums)
        for (const Datum to : all_datums) {
            EXPECT_LT((datum_changed(to, from, datum_changed(from, to, moscow)).r - moscow.r).norm(), 6e-9);
            const Geodetic g{-33.9 * deg, -179.99 * deg, 12.0};
            const Geodetic back = datum_changed(to, from, datum_changed(from, to, g));
            EXPECT_NEAR(back.lat, g.lat, 3e-15);
            EXPECT_NEAR(back.lon, g.lon, 3e-15);
            EXPECT_NEAR(back.h, g.h, 1e-8);
        }
}

TEST(Datum, Sk42ByHand) {
    // SK-42 to PZ-90.11 with the matrix written out in the form of the standard (radians per milliarcsecond 4.84813681e-9).
    const double wx = -2.30 * 4.84813681e-9, wy = -346.46 * 4.84813681e-9, wz = -794.21 * 4.84813681e-9, m = -0.228e-6;
    const Eigen::Vector3d r(2846228.0, 2198800.0, 5249246.0);
    const Eigen::Vector3d by_hand((1 + m) * (r.x() + wz * r.y() - wy * r.z()) + 23.557,
                                  (1 + m) * (-wz * r.x() + r.y() + wx * r.z()) - 140.844,
                                  (1 + m) * (wy * r.x() - wx * r.y() + r.z()) - 79.778);
    EXPECT_LT((datum_changed(Datum::Sk42, Datum::Pz90_11, Ecef{r}).r - by_hand).norm(), 1e-6);
}

TEST(Datum, AgreesWithOtherEditionsOfTheStandard) {
    // SK-42 to WGS-84 directly, GOST R 51794-2008 (EPSG 5044): 23.57, -140.95, -79.8, 0, -0.35", -0.79", -0.22 ppm.
    const Helmert edition_2008{{23.57, -140.95, -79.8}, {0.0, -0.35 * units::arcsec, -0.79 * units::arcsec}, -0.22e-6};
    EXPECT_LT((datum_changed(Datum::Sk42, Datum::Wgs84, moscow).r - transformed(edition_2008, moscow).r).norm(), 0.3);
    // PZ-90 to WGS-84 directly, GOST R 51794-2001 (EPSG 1244), a metre coarser: -1.08, -0.27, -0.90, wz -0.16", -0.12 ppm.
    const Helmert edition_2001{{-1.08, -0.27, -0.90}, {0.0, 0.0, -0.16 * units::arcsec}, -0.12e-6};
    const Eigen::Vector3d pz = datum_changed(Datum::Pz90, Datum::Wgs84, moscow).r - moscow.r;
    EXPECT_GT(pz.norm(), 2.5);
    EXPECT_LT((moscow.r + pz - transformed(edition_2001, moscow).r).norm(), 1.5);
    // PZ-90.02 is 0.36, -0.08, -0.18 from WGS-84, PZ-90.11 some centimetres to decimetres (the standard's own rounding).
    EXPECT_LT((datum_changed(Datum::Pz90_11, Datum::Wgs84, moscow).r - moscow.r).norm(), 0.35);
    const Eigen::Vector3d ed = datum_changed(Datum::Ed50, Datum::Wgs84, moscow).r - moscow.r;
    EXPECT_LT((ed - Eigen::Vector3d(-87, -98, -121)).norm(), 3e-9);
}

TEST(Datum, WgsToPz9011HasThePublishedMatrix) {
    // The reference document prints the matrix itself: -0.02041e-6, -0.01716e-6, -0.01115e-6, (1 - 0.008e-6).
    const Eigen::Vector3d r = moscow.r;
    const Eigen::Vector3d printed((1 - 0.008e-6) * (r.x() - 0.02041e-6 * r.y() - 0.01716e-6 * r.z()) - 0.013,
                                  (1 - 0.008e-6) * (0.02041e-6 * r.x() + r.y() - 0.01115e-6 * r.z()) + 0.106,
                                  (1 - 0.008e-6) * (0.01716e-6 * r.x() + 0.01115e-6 * r.y() + r.z()) + 0.022);
    EXPECT_LT((datum_changed(Datum::Wgs84, Datum::Pz90_11, moscow).r - printed).norm(), 1e-4);
}

TEST(Datum, NamesAndEarthOfASettingsFile) {
    for (const Datum d : all_datums) EXPECT_EQ(datum_from_name(name_of(d)), d);
    EXPECT_EQ(ellipsoid_from_name("wgs84").a, 6378137.0);
    EXPECT_EQ(ellipsoid_from_name("pz90").a, 6378136.0);
    EXPECT_EQ(ellipsoid_from_name("pz90.11").f, 1.0 / 298.25784);
    EXPECT_EQ(ellipsoid_from_name("sk42").a, 6378245.0);
    EXPECT_EQ(ellipsoid_from_name("international1924").f, 1.0 / 297.0);
    EXPECT_NEAR(ellipsoid_from_name("paper_c").e2(), 0.006692, 2e-17);
    EXPECT_EQ(ellipsoid_from_name("paper_c").w_ie, 7.29e-5);
    EXPECT_NEAR(paper_c.gm / (9.78049 * 6378245.0 * 6378245.0), 1.0, 1e-15);
    const Earth earth = earth_from_names("sk42", "kf-gins");
    EXPECT_EQ(earth.ellipsoid.a, 6378245.0);
    EXPECT_EQ(earth.gravity, GravityModel::KfGins);
    for (const char* wrong : {"wgs-85", "", "WGS84 "}) {
        try {
            (void)earth_from_names(wrong, "somigliana");
            FAIL() << wrong;
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::Input);
            for (const char* known : {"wgs84", "pz90", "pz90.11", "sk42", "international1924", "paper_c"})
                EXPECT_NE(std::string(e.what()).find(known), std::string::npos);
        }
    }
    EXPECT_THROW((void)earth_from_names("wgs84", "egm"), Error);
    EXPECT_THROW((void)datum_from_name("nad27"), Error);
}

}  // namespace
