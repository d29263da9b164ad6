// Differences of sine and argument without cancellation.
#pragma once

#include <cmath>

namespace schuler::theory::detail {

/// sum of sign^k x^(2k+3)/(2k+3)!, |x| < 1: the terms beyond those kept are below 1e-17 of the first.
[[nodiscard]] inline double cubic_series(double x, double sign) {
    const double y = sign * x * x;
    double sum = 0.0;
    for (double n = 17.0; n >= 5.0; n -= 2.0) sum = y / (n * (n - 1.0)) * (1.0 + sum);
    return x * x * x / 6.0 * (1.0 + sum);
}

/// sinh x - x.
[[nodiscard]] inline double sinh_minus_argument(double x) { return std::abs(x) < 1.0 ? cubic_series(x, 1.0) : std::sinh(x) - x; }
/// x - sin x.
[[nodiscard]] inline double argument_minus_sin(double x) { return std::abs(x) < 1.0 ? cubic_series(x, -1.0) : x - std::sin(x); }

}  // namespace schuler::theory::detail
