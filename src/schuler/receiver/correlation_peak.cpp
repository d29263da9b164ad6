#include "schuler/receiver/correlation_peak.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace schuler::receiver {

namespace {

using std::numbers::pi;
constexpr double reach = 2.0;    ///< chips
constexpr double nodes = 256.0;  ///< of the table, per chip

/// 1 - cos(2 pi f x) over (pi f)^2 integrated from -b to b; R is a second difference of it, because sin^2(pi f) cos(2 pi f tau)
/// is one of cosines.
double kernel(double x, double b) {
    return 2.0 / (pi * pi) * (2.0 * pi * x * sine_integral(2.0 * pi * b * x) - (1.0 - std::cos(2.0 * pi * b * x)) / b);
}
double kernel_slope(double x, double b) { return 4.0 / pi * sine_integral(2.0 * pi * b * x); }

template <class F>
double second_difference(F f, double tau, double b) {
    return 0.25 * (f(tau + 1.0, b) + f(tau - 1.0, b)) - 0.5 * f(tau, b);
}

}  // namespace

double sine_integral(double x) {
    if (x < 0.0) return -sine_integral(-x);
    if (x < 4.0) {
        double term = x, sum = x;
        for (int k = 1; std::abs(term) > 1e-17 * std::abs(sum) && k < 60; ++k) {
            const double n = 2.0 * k;
            term *= -x * x / (n * (n + 1.0));
            sum += term / (n + 1.0);
        }
        return sum;
    }
    // Si(x) = pi/2 + Im E1(ix), E1 by its continued fraction, evaluated backwards
    const std::complex<double> z(0.0, x);
    std::complex<double> tail = 0.0;
    for (int k = 120; k >= 1; --k) tail = static_cast<double>(k) * k / (z + (2.0 * k + 1.0) - tail);
    return pi / 2.0 + (std::polar(1.0, -x) / (z + 1.0 - tail)).imag();
}

CorrelationPeak::CorrelationPeak(double chip_rate, double bandwidth) {
    if (!(chip_rate > 0.0)) throw input_error(fmt::format("chip rate {} is not positive", chip_rate), {.key = "chip_rate"});
    if (!(bandwidth >= 0.5 * chip_rate))
        throw input_error(fmt::format("front-end bandwidth {} Hz leaves nothing of a code of {} chips/s", bandwidth, chip_rate),
                          {.key = "bandwidth"}, "give at least half the chip rate");
    if (std::isinf(bandwidth)) return;
    const double b = 0.5 * bandwidth / chip_rate;
    const auto count = static_cast<std::size_t>(reach * nodes) + 1;
    table_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double tau = static_cast<double>(i) / nodes;
        table_.push_back({second_difference(kernel, tau, b), second_difference(kernel_slope, tau, b)});
    }
}

double CorrelationPeak::operator()(double tau) const {
    const double distance = std::abs(tau);
    if (table_.empty()) return std::max(0.0, 1.0 - distance);
    if (!(distance < reach)) return 0.0;
    const double place = distance * nodes;
    const auto i = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(i), u = 1.0 - t;
    const Node &a = table_[i], &b = table_[i + 1];
    return u * u * ((1.0 + 2.0 * t) * a.value + t * a.slope / nodes) + t * t * ((1.0 + 2.0 * u) * b.value - u * b.slope / nodes);
}

double CorrelationPeak::slope(double tau) const {
    const double distance = std::abs(tau), sign = tau < 0.0 ? -1.0 : 1.0;
    if (table_.empty()) return distance < 1.0 && distance > 0.0 ? -sign : 0.0;
    if (!(distance < reach)) return 0.0;
    const double place = distance * nodes;
    const auto i = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(i);
    return sign * ((1.0 - t) * table_[i].slope + t * table_[i + 1].slope);
}

}  // namespace schuler::receiver
