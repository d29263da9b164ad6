// Paper A's series: the stated error bounds hold and are not generous.
#include "schuler/earth/paper_series.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace schuler;
using namespace schuler::earth;
using units::deg;

// The paper's ellipsoid: a = 6378388 m with e^2 = 6.73e-3 or with that of 1/297.
struct Worst {
    double meridian_1 = 0, meridian_2 = 0, prime_1 = 0, prime_2 = 0;
};

Worst worst_curvature(const Ellipsoid& e) {
    Worst worst;
    for (double lat = 0; lat <= 90; lat += 0.5)
        for (double h = 0; h <= 20000; h += 500) {
            const double s2 = std::pow(std::sin(lat * deg), 2);
            const Radii r = radii(e, lat * deg);
            const CurvatureSeries first = paper_a_curvature_first_order(e.e2(), s2, h / e.a);
            const CurvatureSeries second = paper_a_curvature_second_order(e.e2(), s2, h / e.a);
            const double m = (r.meridian + h) / e.a, n = (r.prime_vertical + h) / e.a;
            worst.meridian_1 = std::max(worst.meridian_1, std::abs(first.meridian * m - 1));
            worst.meridian_2 = std::max(worst.meridian_2, std::abs(second.meridian * m - 1));
            worst.prime_1 = std::max(worst.prime_1, std::abs(first.prime_vertical * n - 1));
            worst.prime_2 = std::max(worst.prime_2, std::abs(second.prime_vertical * n - 1));
        }
    return worst;
}

TEST(PaperSeries, CurvatureErrorsAreTheStatedOnes) {
    const Worst worst = worst_curvature(international1924);
    EXPECT_NEAR(worst.meridian_1, 4.52929e-05, 0.01 * 4.53e-5);
    EXPECT_NEAR(worst.meridian_2, 3.04821e-07, 0.03 * 3.05e-7);
    EXPECT_NEAR(worst.prime_1, 2.52880e-05, 0.01 * 2.53e-5);
    EXPECT_NEAR(worst.prime_2, 1.49506e-07, 0.03 * 1.50e-7);
}

// Normal gravity of 1930 (Cassinis) in Somigliana's form, with second-order free air, as the reference of math.md 2.7.
double gravity_1930(double lat, double h) {
    const double f = 1.0 / 297.0, e2 = f * (2 - f), a = 6378388.0, g_e = 9.78049, g_p = 9.83221298502, m = 0.00344986;
    const double s2 = std::pow(std::sin(lat), 2);
    const double k = (1 - f) * g_p / g_e - 1;
    const double g0 = g_e * (1 + k * s2) / std::sqrt(1 - e2 * s2);
    return g0 * (1 - 2 / a * (1 + f + m - 2 * f * s2) * h + 3 * h * h / (a * a));
}

TEST(PaperSeries, GravityErrorsAreTheStatedOnes) {
    double l1 = 0, l3 = 0, l1_surface_with_corrected_e2 = 0;
    const PaperAGravity paper;
    for (double lat = 0; lat <= 90; lat += 0.5) {
        const double s2 = std::pow(std::sin(lat * deg), 2);
        for (double h = 0; h <= 20000; h += 500) {
            const double truth = gravity_1930(lat * deg, h);
            l1 = std::max(l1, std::abs(paper_a_gravity_l1(paper, s2, h).down - truth));
            l3 = std::max(l3, std::abs(paper_a_gravity_l3(paper, s2, h) - truth));
        }
        l1_surface_with_corrected_e2 =
            std::max(l1_surface_with_corrected_e2,
                     std::abs(paper_a_gravity_l1(paper_a_gravity_international, s2, 0).down - gravity_1930(lat * deg, 0)));
    }
    EXPECT_NEAR(l1, 4.12556e-5, 3e-7);
    EXPECT_NEAR(l3, 2.09018e-4, 3e-7);
    EXPECT_LT(l1_surface_with_corrected_e2, 1.45e-6);
}

}  // namespace
