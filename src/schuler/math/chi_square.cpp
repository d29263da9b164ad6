#include "schuler/math/chi_square.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::math {

namespace {

/// Of positive numbers. std::lgamma leaves the sign in a global variable, where threads would meet.
double log_gamma(double x) {
    int sign = 0;
    return lgamma_r(x, &sign);
}

/// d - log(1 + d), without cancellation near zero; d > -1.
double excess_over_log(double d) {
    if (std::abs(d) > 0.1) return d - std::log1p(d);
    double sum = 0.0, power = d;
    for (int k = 2; k < 24; ++k) {  // sum of (-d)^k / k: the last term is below 1e-16 of the first
        power *= -d;
        sum -= power / k;
    }
    return sum;
}

/// x^a exp(-x) / Gamma(a + 1), x > 0, by the saddle-point form where the plain one would cancel (Loader 2000).
double gamma_prefactor(double a, double x) {
    if (a < 15.0) return std::exp(a * std::log(x) - x - log_gamma(a + 1.0));
    const double a2 = a * a;
    // log Gamma(a + 1) less Stirling's leading part; Abramowitz and Stegun 6.1.41.
    const double stirling = (1.0 / 12 - (1.0 / 360 - (1.0 / 1260 - (1.0 / 1680 - 1.0 / (1188 * a2)) / a2) / a2) / a2) / a;
    return std::exp(-a * excess_over_log((x - a) / a) - stirling) / std::sqrt(2.0 * std::numbers::pi * a);
}

struct Tails {
    double lower, upper;
};

/// Regularised incomplete gamma functions P(a, x) and Q(a, x): series left of a + 1 (Abramowitz and Stegun 6.5.29), continued
/// fraction right of it (6.5.31, evaluated by Lentz's method).
Tails incomplete_gamma(double a, double x) {
    constexpr double eps = std::numeric_limits<double>::epsilon();
    const double prefactor = gamma_prefactor(a, x);
    if (x < a + 1.0) {
        double term = 1.0, sum = 1.0;
        for (double k = a + 1.0; term > 0.1 * eps * sum; k += 1.0) {
            term *= x / k;
            sum += term;
        }
        const double lower = std::min(1.0, prefactor * sum);
        return {lower, 1.0 - lower};
    }
    constexpr double tiny = 1e-300;
    double b = x + 1.0 - a, c = 1.0 / tiny, d = 1.0 / b, fraction = d;
    for (int i = 1; i < 1000000; ++i) {
        const double numerator = -i * (i - a);
        b += 2.0;
        d = numerator * d + b;
        if (std::abs(d) < tiny) d = tiny;
        c = b + numerator / c;
        if (std::abs(c) < tiny) c = tiny;
        d = 1.0 / d;
        const double factor = d * c;
        fraction *= factor;
        if (std::abs(factor - 1.0) < eps) break;
    }
    const double upper = std::min(1.0, prefactor * a * fraction);  // prefactor * a = x^a exp(-x) / Gamma(a)
    return {1.0 - upper, upper};
}

Tails tails(double x, double dof) {
    if (!(dof > 0.0) || !std::isfinite(dof)) {
        throw input_error(fmt::format("chi-square with {} degrees of freedom", dof), {}, "the number must be positive");
    }
    if (std::isnan(x)) throw input_error("chi-square probability of a value that is not a number");
    if (x <= 0.0) return {0.0, 1.0};
    if (std::isinf(x)) return {1.0, 0.0};
    return incomplete_gamma(0.5 * dof, 0.5 * x);
}

/// Start of the search: Wilson and Hilferty 1931 with a rough normal quantile, or the leading term of the lower tail.
double first_guess(double p, double dof) {
    const double tail = std::min(p, 1.0 - p);
    const double t = std::sqrt(-2.0 * std::log(std::max(tail, 1e-300)));
    const double z = t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    const double k = 2.0 / (9.0 * dof);
    const double root = 1.0 - k + (p < 0.5 ? -z : z) * std::sqrt(k);
    const double by_cube = dof * root * root * root;
    const double a = 0.5 * dof;
    const double by_tail = 2.0 * std::exp((std::log(p) + log_gamma(a + 1.0)) / a);
    return root > 0.3 ? by_cube : by_tail;
}

}  // namespace

double chi_square_cdf(double x, double dof) { return tails(x, dof).lower; }

double chi_square_survival(double x, double dof) { return tails(x, dof).upper; }

double chi_square_quantile(double p, double dof) {
    if (!(p > 0.0 && p < 1.0)) {
        throw input_error(fmt::format("chi-square quantile of probability {}", p), {}, "the probability must be between 0 and 1");
    }
    double x = first_guess(p, dof);
    double low = 0.0, high = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 200; ++i) {
        const Tails at = tails(x, dof);
        const double off = p < 0.5 ? at.lower - p : (1.0 - p) - at.upper;  // in the smaller tail: no cancellation
        (off > 0.0 ? high : low) = x;
        const double density = 0.5 * gamma_prefactor(0.5 * dof, 0.5 * x) * dof / x;
        // Halley's step; the logarithmic derivative of the density is (dof/2 - 1)/x - 1/2.
        const double newton = off / density;
        const double curvature = std::clamp(0.5 * newton * ((0.5 * dof - 1.0) / x - 0.5), -0.5, 0.5);
        double next = x - newton / (1.0 - curvature);
        if (!(next > low && next < high)) next = std::isinf(high) ? 2.0 * x : 0.5 * (low + high);
        if (std::abs(next - x) <= 4e-16 * x) return next;
        x = next;
    }
    return x;
}

}  // namespace schuler::math
