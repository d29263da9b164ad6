#include "schuler/math/binomial.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::math {
namespace {

/// P(at most k events) by its terms.
double at_most(std::size_t k, std::size_t n, double p) {
    double sum = 0.0;
    for (std::size_t i = 0; i <= k; ++i) {
        const auto x = static_cast<double>(i), m = static_cast<double>(n);
        sum += std::exp(std::lgamma(m + 1.0) - std::lgamma(x + 1.0) - std::lgamma(m - x + 1.0) + x * std::log(p) +
                        (m - x) * std::log1p(-p));
    }
    return sum;
}

// What the bounds are: at the upper one so few events, at the lower one so many, have the probability of a tail.
TEST(BinomialBounds, TailsAreThoseAskedFor) {
    for (const std::size_t n : {1u, 5u, 48u, 1000u}) {
        for (const std::size_t k : {std::size_t{0}, std::size_t{1}, n / 3, n - 1, n}) {
            const auto [low, high] = binomial_bounds(k, n, 0.95);
            if (k < n) {
                EXPECT_NEAR(at_most(k, n, high), 0.025, 1e-11) << k << " of " << n;
            } else {
                EXPECT_EQ(high, 1.0);
            }
            if (k > 0) {
                EXPECT_NEAR(1.0 - at_most(k - 1, n, low), 0.025, 1e-11) << k << " of " << n;
            } else {
                EXPECT_EQ(low, 0.0);
            }
        }
    }
    EXPECT_THROW((void)binomial_bounds(3, 2, 0.95), Error);
    EXPECT_THROW((void)binomial_bounds(1, 2, 1.0), Error);
}

// No event in n trials: 1 - 0.025^(1/n).
TEST(BinomialBounds, NoEvent) { EXPECT_NEAR(binomial_bounds(0, 1000, 0.95)[1], 1.0 - std::pow(0.025, 1e-3), 1e-15); }

}  // namespace
}  // namespace schuler::math
