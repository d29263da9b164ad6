#include "schuler/sim/uniform_spline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::sim {

namespace {

constexpr int degree = 5;

/// Uniform B-spline of degree m at x in [0, 1] of the interval determined by its m + 1 values: de Boor's algorithm.
double de_boor(std::array<double, degree + 1> d, int m, double x) {
    for (int r = 1; r <= m; ++r) {
        for (int j = m; j >= r; --j) {
            const double alpha = (x + m - j) / (m + 1 - r);
            const auto at = static_cast<std::size_t>(j);
            d[at] = (1.0 - alpha) * d[at - 1] + alpha * d[at];
        }
    }
    return d[static_cast<std::size_t>(m)];
}

}  // namespace

UniformSpline::UniformSpline(double spacing, std::vector<double> controls) : spacing_(spacing), controls_(std::move(controls)) {}

Jet<4> UniformSpline::at(double x) const {
    const double knots = x / spacing_;
    const long last = static_cast<long>(controls_.size()) - 1;
    const long interval = std::clamp(static_cast<long>(std::floor(knots)), -3L, last + 3L);
    const double inside = std::clamp(knots - static_cast<double>(interval), 0.0, 1.0);

    std::array<double, degree + 1> d;
    for (long j = 0; j <= degree; ++j) {
        const long index = std::clamp(interval - 2 + j, 0L, last);
        d[static_cast<std::size_t>(j)] = controls_[static_cast<std::size_t>(index)];
    }
    // The k-th derivative is the spline of degree 5 - k of the k-th differences.
    Jet<4> out;
    double factor = 1.0;
    for (int k = 0; k <= 4; ++k) {
        out.c[static_cast<std::size_t>(k)] = factor * de_boor(d, degree - k, inside);
        for (std::size_t j = 0; j + 1 < d.size() - static_cast<std::size_t>(k); ++j) d[j] = d[j + 1] - d[j];
        factor /= spacing_ * (k + 1);
    }
    return out;
}

}  // namespace schuler::sim
