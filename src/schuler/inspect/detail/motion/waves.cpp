#include "schuler/inspect/detail/motion/waves.h"

#include "schuler/core/units.h"
#include "schuler/inspect/detail/robust.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace schuler::inspect::detail {
namespace {

using Eigen::Vector3d;
using Series = std::vector<Vector3d>;

constexpr double step = 0.2;                                       // s
constexpr double shortest = 1.4, longest = 20.0, slowest = 120.0;  // s, lengths of the means that separate the periods

/// Means over intervals of `step`.
struct Decimated {
    Series angle;  ///< integrated rates less their mean, rad
    Series force;  ///< m/s^2
};

Decimated decimated(const ImuSeries& imu, double from, double to) {
    Decimated d;
    Series rate;
    Vector3d mean = Vector3d::Zero();
    for (std::size_t i = index_before(imu.t, from); i < imu.size() && imu.t[i] < to;) {
        const double end = imu.t[i] + step - 0.5 * imu.step;
        Vector3d w = Vector3d::Zero(), f = Vector3d::Zero();
        const std::size_t first = i;
        for (; i < imu.size() && imu.t[i] < end; ++i) {
            w += imu.w[i];
            f += imu.f[i];
        }
        const auto n = static_cast<double>(i - first);
        rate.push_back(w / n);
        d.force.push_back(f / n);
        mean += w / n;
    }
    if (rate.empty()) return d;
    mean /= static_cast<double>(rate.size());
    Vector3d angle = Vector3d::Zero();
    const double dt = (to - from) / static_cast<double>(rate.size());  // the samples may not divide a step
    for (const Vector3d& w : rate) d.angle.push_back(angle += dt * (w - mean));
    return d;
}

/// Centred means over `length` (s), shorter ones at the ends.
Series smoothed(const Series& x, double length) {
    const auto half = static_cast<std::size_t>(std::lround(0.5 * length / step));
    Series sums(x.size() + 1, Vector3d::Zero()), out(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) sums[i + 1] = sums[i] + x[i];
    for (std::size_t i = 0; i < x.size(); ++i) {
        const std::size_t reach = std::min({half, i, x.size() - 1 - i});
        out[i] = (sums[i + reach + 1] - sums[i - reach]) / static_cast<double>(2 * reach + 1);
    }
    return out;
}

/// Difference of the short and the long mean, perpendicular to `down`.
Series band(const Series& fine, const Series& coarse, const Vector3d& down) {
    Series out(fine.size());
    for (std::size_t i = 0; i < fine.size(); ++i) {
        const Vector3d x = fine[i] - coarse[i];
        out[i] = x - x.dot(down) * down;
    }
    return out;
}

double mean_square(const Series& x, std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t i = first; i < last; ++i) sum += x[i].squaredNorm();
    return last > first ? sum / static_cast<double>(last - first) : 0.0;
}

double height_range(const GnssSeries& gnss) {
    std::vector<double> means;
    for (std::size_t i = 0; i < gnss.size();) {
        double sum = 0.0, n = 0.0;
        for (const double until = gnss.t[i] + 60.0; i < gnss.size() && gnss.t[i] < until; ++i, n += 1.0) sum += gnss.p[i].z();
        means.push_back(sum / n);
    }
    return quantile(means, 0.95) - quantile(means, 0.05);
}

}  // namespace

Waves waves_of(const ImuSeries& imu, const GnssSeries& gnss) {
    Waves out;
    if (imu.empty() || gnss.empty() || !gnss.has_height || imu.step > step) return out;
    const double from = std::max(imu.t.front(), gnss.t.front()), to = std::min(imu.t.back(), gnss.t.back());
    if (to - from < slowest) return out;
    const Decimated d = decimated(imu, from, to);
    Vector3d down = Vector3d::Zero();
    for (const Vector3d& f : d.force) down -= f;
    if (!(down.norm() > 0.0)) return out;
    const double g = down.norm() / static_cast<double>(d.force.size());
    down.normalize();
    const Series coarse = smoothed(d.angle, longest);
    const Series fast = smoothed(d.angle, shortest);
    const Series tilt = band(fast, coarse, down), slow = band(coarse, smoothed(d.angle, slowest), down),
                 quick = band(d.angle, fast, down);
    const Series force = band(smoothed(d.force, shortest), smoothed(d.force, longest), down);
    const std::size_t n = tilt.size();
    out.tilt =
        std::sqrt(std::min({mean_square(tilt, 0, n / 3), mean_square(tilt, n / 3, 2 * n / 3), mean_square(tilt, 2 * n / 3, n)}));
    const double of_waves = mean_square(tilt, 0, n), all = of_waves + mean_square(slow, 0, n) + mean_square(quick, 0, n);
    out.share = all > 0.0 ? of_waves / all : 0.0;
    double left = 0.0;
    for (std::size_t i = 0; i < n; ++i) left += (force[i] - g * tilt[i].cross(down)).squaredNorm();
    const double whole = mean_square(force, 0, n) * static_cast<double>(n);
    out.felt = whole > 0.0 ? 1.0 - left / whole : 0.0;
    out.height = height_range(gnss);
    constexpr double least_tilt = 0.15 * units::deg, least_share = 0.6, least_felt = 0.5;
    constexpr double level = 8.0;  // m
    out.found = out.tilt > least_tilt && out.share > least_share && out.felt > least_felt && out.height < level;
    return out;
}

}  // namespace schuler::inspect::detail
