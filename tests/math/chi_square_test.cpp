#include "schuler/math/chi_square.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::math {
namespace {

void expect_relative(double actual, double expected, double tolerance) {
    EXPECT_LT(std::abs(actual / expected - 1.0), tolerance) << actual << " for " << expected;
}

// Made with 150 digits from the power series of the incomplete gamma function and Gamma(n/2) as a product.
TEST(ChiSquare, ProbabilitiesOfBothTails) {
    struct Row {
        double x, dof, lower, upper;
    };
    const Row table[] = {
        {0.001, 1, 0.025227120630039613, 0.9747728793699604},   {0.5, 1, 0.5204998778130465, 0.4795001221869535},
        {3.841, 1, 0.9499863162360433, 0.05001368376395671},    {100, 1, 1.0, 1.523970604832105e-23},
        {1e-6, 3, 2.6596144047917997e-10, 0.9999999997340385},  {7.8, 3, 0.9496689021401467, 0.05033109785985335},
        {60, 3, 0.9999999999994121, 5.878230727906912e-13},     {5, 10, 0.10882198108584876, 0.8911780189141513},
        {29.9, 30, 0.5292160852467049, 0.470783914753295},      {31, 31, 0.5337874937824917, 0.46621250621750837},
        {200, 100, 0.9999999882154993, 1.1784500720979422e-08}, {40, 100, 1.245892607971938e-08, 0.9999999875410739},
        {1000, 1000, 0.5059471461707603, 0.49405285382923964},  {1200, 1000, 0.9999877440576693, 1.2255942330622905e-05},
        {850, 1000, 0.00021325999770297618, 0.9997867400022971}};
    for (const Row& row : table) {
        expect_relative(chi_square_cdf(row.x, row.dof), row.lower, 1e-12);
        expect_relative(chi_square_survival(row.x, row.dof), row.upper, 1e-12);
    }
}

TEST(ChiSquare, Quantiles) {
    struct Row {
        double p, dof, x;
    };
    // clang-format off
    const Row table[] = {{0.95, 1, 3.841458820694126},    {0.95, 2, 5.991464547107982},     {0.95, 3, 7.81472790325118},
                         {0.99, 3, 11.34486673014437},    {0.999, 6, 22.45774448482533},    {0.025, 3, 0.2157952826238979},
                         {0.975, 3, 9.348403604496148},   {0.025, 144, 112.6711313803767},  {0.975, 144, 179.1136782142012},
                         {1e-8, 5, 0.002040737224936532}, {0.5, 1, 0.4549364231195728}};
    // clang-format on
    for (const Row& row : table) expect_relative(chi_square_quantile(row.p, row.dof), row.x, 1e-12);
}

// Two degrees of freedom have a closed form: P(X > x) = exp(-x/2). Also fractional dof and a million of them, by inversion.
TEST(ChiSquare, ClosedFormAndInversion) {
    for (const double x : {1e-12, 0.1, 1.0, 1.9999, 2.0001, 4.0, 30.0, 600.0}) {
        expect_relative(chi_square_survival(x, 2.0), std::exp(-0.5 * x), 1e-12);
        expect_relative(chi_square_cdf(x, 2.0), -std::expm1(-0.5 * x), 1e-12);
    }
    for (const double dof : {0.3, 1.7, 29.99, 30.01, 4321.5, 1e6}) {
        for (const double p : {1e-12, 0.01, 0.4, 0.5, 0.77}) {
            expect_relative(chi_square_cdf(chi_square_quantile(p, dof), dof), p, 2e-11);
            expect_relative(chi_square_survival(chi_square_quantile(1.0 - p, dof), dof), 1.0 - (1.0 - p), 2e-11);
        }
    }
}

TEST(ChiSquare, OutsideTheDomain) {
    EXPECT_EQ(chi_square_cdf(-1.0, 3.0), 0.0);
    EXPECT_EQ(chi_square_survival(0.0, 3.0), 1.0);
    EXPECT_THROW((void)chi_square_cdf(1.0, 0.0), Error);
    EXPECT_THROW((void)chi_square_cdf(std::nan(""), 1.0), Error);
    EXPECT_THROW((void)chi_square_quantile(0.0, 3.0), Error);
    EXPECT_THROW((void)chi_square_quantile(1.0, 3.0), Error);
    EXPECT_THROW((void)chi_square_quantile(0.5, -2.0), Error);
}

}  // namespace
}  // namespace schuler::math
