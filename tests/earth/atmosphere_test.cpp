// Standard atmosphere against the values of ICAO Doc 7488 and the hydrostatic equation.
#include "schuler/earth/atmosphere.h"
#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace schuler;
using namespace schuler::earth;

TEST(Atmosphere, TabulatedValues) {
    struct Row {
        double height, temperature, pressure, relative;
    };
    for (const Row& row : {Row{0, 288.15, 101325.0, 1e-12}, Row{5000, 255.65, 54019.9, 1e-6}, Row{11000, 216.65, 22632.1, 3e-6},
                           Row{20000, 216.65, 5474.88, 2e-6}, Row{32000, 228.65, 868.019, 5e-6},
                           Row{47000, 270.65, 110.906, 5e-6}, Row{-1000, 294.65, 113929.0, 5e-6}}) {
        const StandardAir air = standard_air(row.height);
        EXPECT_NEAR(air.temperature, row.temperature, 1e-9);
        EXPECT_NEAR(air.pressure / row.pressure, 1.0, row.relative) << row.height;
    }
    EXPECT_NEAR(standard_air(0).density, 1.225, 1e-6);
    // Geometric 10 km: 223.252 K and 264.999 hPa.
    const StandardAir at_10_km = standard_air(geopotential_from_geometric(10000.0));
    EXPECT_NEAR(at_10_km.temperature, 223.252, 5e-4);
    EXPECT_NEAR(at_10_km.pressure, 26499.9, 0.1);
}

TEST(Atmosphere, HydrostaticInEveryLayer) {
    for (double h = -4900; h < 79900; h += 700) {
        const double dh = 2.0;
        const double slope = (standard_air(h + dh).pressure - standard_air(h - dh).pressure) / (2 * dh);
        const double weight = -9.80665 * standard_air(h).density;
        EXPECT_NEAR(slope / weight, 1.0, 1e-6) << h;
    }
}

TEST(Atmosphere, HeightOfPressureIsTheInverse) {
    for (double h = -5000; h <= 80000; h += 50)
        EXPECT_NEAR(geopotential_height_from_pressure(standard_air(h).pressure), h, h <= 20000 ? 1e-9 : 1e-7);
    // With another sea level pressure, sea level itself reads zero.
    EXPECT_NEAR(geopotential_height_from_pressure(99000.0, 99000.0), 0.0, 1e-9);
    EXPECT_GT(geopotential_height_from_pressure(99000.0), 190.0);
    for (const double h : {-500.0, 0.0, 1234.5, 20000.0})
        EXPECT_NEAR(geopotential_from_geometric(geometric_from_geopotential(h)), h, 1e-10);
    EXPECT_NEAR(geometric_from_geopotential(11000.0), 11019.07, 0.01);
}

TEST(Atmosphere, PressureOfTheDayIsHydrostaticAndStandardWhereTheDayIs) {
    for (const double h : {-400.0, 0.0, 3000.0, 11000.0, 15000.0, 25000.0})
        EXPECT_NEAR(static_pressure(h, 101325.0, 0.0) / standard_air(h).pressure, 1.0, 1e-13) << h;
    // dp/dH = -g0 p / (R (T + dT)), integrated from sea level by Simpson's rule in ln p.
    for (const double offset : {-30.0, 20.0}) {
        for (const double top : {8000.0, 11000.0, 18000.0}) {
            const int n = 1800;  // the tropopause is a point of the grid
            double sum = 0.0;
            for (int i = 0; i <= n; ++i)
                sum += (i == 0 || i == n ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) / (standard_air(top * i / n).temperature + offset);
            const double expected = 98000.0 * std::exp(-9.80665 / 287.05287 * sum * top / n / 3.0);
            EXPECT_NEAR(static_pressure(top, 98000.0, offset) / expected, 1.0, 1e-9) << top << " " << offset;
        }
    }
    EXPECT_THROW((void)static_pressure(0.0, 0.0, 0.0), Error);
    EXPECT_THROW((void)static_pressure(0.0, 101325.0, 400.0), Error);
}

TEST(Atmosphere, OutsideIsAnErrorNotANumber) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double p : {0.0, -1.0, nan, 1013.25e3}) EXPECT_THROW((void)geopotential_height_from_pressure(p), Error) << p;
    EXPECT_THROW((void)geopotential_height_from_pressure(90000.0, 0.0), Error);
    EXPECT_THROW((void)geopotential_height_from_pressure(90000.0, nan), Error);
    for (const double h : {-5001.0, 80001.0, nan}) EXPECT_THROW((void)standard_air(h), Error) << h;
}

}  // namespace
