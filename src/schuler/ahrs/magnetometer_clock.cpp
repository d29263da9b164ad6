#include "schuler/ahrs/magnetometer_clock.h"

#include "schuler/ahrs/field_turns.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace schuler::ahrs {
namespace {

using Eigen::Matrix3d;

constexpr double farthest = 0.5, coarse = 0.04, fine = 0.005;  // s
constexpr double least_delay = 0.03;                           // s
constexpr double neighbour = 0.1;                              // s, within which delays are the same hypothesis
constexpr double well_explained = 0.1;  // unexplained part of the changes with which the axes need no doubt
constexpr std::size_t enough_pairs = 2000;

/// Unexplained part of the changes over a grid of delays.
struct Curve {
    std::vector<double> delay, left;

    [[nodiscard]] std::size_t lowest() const { return static_cast<std::size_t>(std::ranges::min_element(left) - left.begin()); }
    /// Abscissa of the lowest point of the parabola through the lowest value and its neighbours.
    [[nodiscard]] double vertex() const {
        const std::size_t k = lowest();
        if (k == 0 || k + 1 >= left.size()) return delay[k];
        const double bend = left[k - 1] - 2.0 * left[k] + left[k + 1];
        return bend > 0.0 ? delay[k] + 0.5 * (left[k - 1] - left[k + 1]) / bend * (delay[k + 1] - delay[k]) : delay[k];
    }
};

}  // namespace

MagnetometerClock find_delay(std::span<const ImuSample> imu, std::span<const MagSample> mag) {
    MagnetometerClock out;
    const Turning turning(imu);
    const FieldTurns given(turning, mag);
    if (!given.enough()) return out;
    const std::size_t every = 1 + given.size() / enough_pairs;
    const auto left_at = [&](double delay, const Matrix3d& C) {
        const FieldTurns turns(turning, mag, delay, every);
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
    Curve rough = curve(-farthest, farthest, coarse, C);
    if (rough.left[rough.lowest()] > well_explained) {
        for (const Matrix3d& candidate : axes_candidates()) {
            const Curve other = curve(-farthest, farthest, coarse, candidate);
            if (equal_within * other.left[other.lowest()] >= rough.left[rough.lowest()]) continue;
            rough = other;
            C = candidate;
        }
    }
    const double near = rough.delay[rough.lowest()];
    const Curve close = curve(near - coarse, near + coarse, fine, C);
    const double best = close.left[close.lowest()], as_given = left_at(0.0, C);
    out.as_given = out.explained = 1.0 - as_given;
    if (std::abs(close.vertex()) < least_delay || best > unconvincing || !given.clearly_worse(as_given, best)) return out;
    // a steady oscillation agrees again a period later
    for (std::size_t k = 1; k + 1 < rough.left.size(); ++k)
        if (std::abs(rough.delay[k] - near) > neighbour && rough.left[k] < equal_within * best) return out;
    out.delay = close.vertex();
    out.explained = 1.0 - best;
    return out;
}

}  // namespace schuler::ahrs
