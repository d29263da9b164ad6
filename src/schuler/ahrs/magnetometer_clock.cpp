#include "schuler/ahrs/magnetometer_clock.h"

#include "schuler/ahrs/field_turns.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace schuler::ahrs {
namespace {

using Eigen::Matrix3d;

constexpr double farthest = 0.5, looked_at = 1.2, coarse = 0.04, fine = 0.005;  // s
constexpr double least_delay = 0.03;                                            // s
constexpr double neighbour = 0.1;                                               // s, within which delays are the same hypothesis
constexpr double well_explained = 0.1;      // unexplained part of the changes with which the axes need no doubt
constexpr double least_unexplained = 0.01;  // less is the interpolation's, and no evidence
constexpr std::size_t enough_pairs = 2000;

/// Unexplained part of the changes over a grid of delays.
struct Curve {
    std::vector<double> delay, left;

    [[nodiscard]] std::size_t lowest() const { return static_cast<std::size_t>(std::ranges::min_element(left) - left.begin()); }
    [[nodiscard]] bool is_minimum(std::size_t k) const {
        return (k == 0 || left[k] <= left[k - 1]) && (k + 1 == left.size() || left[k] <= left[k + 1]);
    }
    /// Abscissa of the lowest point of the parabola through the lowest value and its neighbours.
    [[nodiscard]] double vertex() const {
        const std::size_t k = lowest();
        if (k == 0 || k + 1 >= left.size()) return delay[k];
        const double bend = left[k - 1] - 2.0 * left[k] + left[k + 1];
        return bend > 0.0 ? delay[k] + 0.5 * (left[k - 1] - left[k + 1]) / bend * (delay[k + 1] - delay[k]) : delay[k];
    }
};

struct Minimum {
    double delay, left;
};

}  // namespace

MagnetometerClock find_delay(std::span<const ImuSample> imu, std::span<const MagSample> mag) {
    MagnetometerClock out;
    const Turning turning(imu);
    const std::vector<ReadingPair> readings = reading_pairs(mag, enough_pairs);
    const FieldTurns given(turning, readings);
    if (!given.enough()) return out;
    const auto left_at = [&](double delay, const Matrix3d& C) {
        const FieldTurns turns(turning, readings, delay);
        return turns.changes() > 0.0 ? turns.unexplained(C).left / turns.changes() : 1.0;
    };
    const auto curve = [&](double from, double to, double step, const Matrix3d& C) {
        Curve c;
        for (double d = from; d < to + 0.5 * step; d += step) {
            c.delay.push_back(d);
            c.left.push_back(left_at(d, C));
        }
        return c;
    };
    Matrix3d C = Matrix3d::Identity();
    Curve rough = curve(-looked_at, looked_at, coarse, C);
    if (rough.left[rough.lowest()] > well_explained) {
        for (const Matrix3d& candidate : axes_candidates()) {
            const Curve other = curve(-looked_at, looked_at, coarse, candidate);
            if (equal_within * other.left[other.lowest()] >= rough.left[rough.lowest()]) continue;
            rough = other;
            C = candidate;
        }
    }
    std::vector<Minimum> minima;
    for (std::size_t k = 0; k < rough.left.size(); ++k) {
        if (!rough.is_minimum(k) || rough.left[k] > unconvincing) continue;
        const double delay = curve(rough.delay[k] - coarse, rough.delay[k] + coarse, fine, C).vertex();
        minima.push_back({delay, left_at(delay, C)});
    }
    const double as_given = left_at(0.0, C);
    out.as_given = out.explained = 1.0 - as_given;
    const auto best = std::ranges::min_element(minima, {}, &Minimum::left);
    if (best == minima.end() || std::abs(best->delay) < least_delay || std::abs(best->delay) > farthest ||
        !given.clearly_worse(as_given, best->left))
        return out;
    // a steady oscillation agrees again a period later
    const double reached = std::max(best->left, least_unexplained);
    for (const Minimum& other : minima)
        if (std::abs(other.delay - best->delay) > neighbour && !given.clearly_worse(other.left, reached)) return out;
    out.delay = best->delay;
    out.explained = 1.0 - best->left;
    return out;
}

}  // namespace schuler::ahrs
