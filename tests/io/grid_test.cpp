// Grids from text: between the points against an analytic field, and what is no grid.
#include "io_fixture.h"
#include "schuler/core/units.h"
#include "schuler/io/text/csv/csv_grid.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

class GridFile : public test::IoTest {
protected:
    [[nodiscard]] GeodeticGrid read(const std::string& text) const {
        return read_grid_csv(TextInput(write("grid.csv", text)), {"east_mgal", "north_mgal", "up_mgal"}, units::mgal);
    }
};

TEST_F(GridFile, BetweenThePointsItIsTheFieldUpToItsCurvature) {
    // Waves of 10 km in latitude and 12 km in longitude, points each 0.005 and 0.01 degrees, in shuffled order.
    const double a = 2.0 * std::numbers::pi / 0.09, o = 2.0 * std::numbers::pi / 0.16;  // per degree
    const auto field = [&](double lat, double lon) {
        return Eigen::Vector3d(20.0 * std::sin(a * lat), 10.0 * std::cos(o * lon), 30.0 * std::sin(a * lat) * std::sin(o * lon));
    };
    std::string text = "# east, north, up\nlon_deg;extra;lat_deg;up_mgal;east_mgal;north_mgal\n";
    for (int k = 0; k < 41 * 31; ++k) {
        const int point = k * 500 % (41 * 31);  // prime to their number: every point once
        const double lat = 55.0 + 0.005 * (point / 31), lon = -0.1 + 0.01 * (point % 31);
        const Eigen::Vector3d v = field(lat, lon);
        text += fmt::format("{:.2f};x;{:.3f};{:.9f};{:.9f};{:.9f}\n", lon, lat, v.z(), v.x(), v.y());
    }
    const GeodeticGrid grid = read(text);
    // Bilinear: an eighth of the square of the spacing by the curvature, of both directions.
    const double bound = (std::pow(0.005 * a, 2) + std::pow(0.01 * o, 2)) / 8.0 * 30.0;
    double worst = 0.0;
    for (double lat = 55.0; lat <= 55.2; lat += 0.00137)
        for (double lon = -0.1; lon <= 0.2; lon += 0.00371) {
            const Eigen::Vector3d error = grid.at(lat * units::deg, lon * units::deg) / units::mgal - field(lat, lon);
            worst = std::max(worst, error.cwiseAbs().maxCoeff());
        }
    EXPECT_LT(worst, 1.001 * bound);
    EXPECT_GT(worst, 0.5 * bound);  // the bound is near: what lies between is not the nearest point
    EXPECT_TRUE(grid.covers(55.1 * units::deg, 0.0));
    EXPECT_FALSE(grid.covers(55.21 * units::deg, 0.0));
    EXPECT_EQ(grid.at(1.5, 0.0), grid.at(55.2 * units::deg, 0.0));
}

TEST_F(GridFile, WhatIsNoGridIsRefusedWithItsLine) {
    const std::string head = "lat_deg,lon_deg,east_mgal,north_mgal,up_mgal\n", row = "1,2,0,0,5\n1,3,0,0,5\n2,2,0,0,5\n";
    EXPECT_NO_THROW((void)read(head + row + "2,3,0,0,5\n"));
    expect_parts(message_of([&] { (void)read(head + row); }), {"grid.csv", "lacks the point", "lat_deg 2", "lon_deg 3"});
    expect_parts(message_of([&] { (void)read(head + row + "2,3,0,x,5\n"); }), {"grid.csv:5", "north_mgal"});
    expect_parts(message_of([&] { (void)read(head + row + "1,3,0,0,6\n"); }), {"grid.csv:5", "point above"});
    expect_parts(message_of([&] { (void)read(head + row + "92,3,0,0,5\n"); }), {"grid.csv:5", "lat_deg"});
    expect_parts(message_of([&] { (void)read("lat_deg,lon_deg,up_mgal\n1,2,3\n"); }), {"grid.csv:1", "east_mgal"});
    expect_parts(message_of([&] { (void)read(head + "1,2,0,0,5\n1,3,0,0,5\n"); }), {"1 latitudes", "at least two"});
}

}  // namespace
}  // namespace schuler::io
