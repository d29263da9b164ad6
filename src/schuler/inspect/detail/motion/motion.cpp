#include "schuler/inspect/detail/motion/motion.h"

#include "schuler/earth/earth.h"
#include "schuler/inspect/detail/robust.h"

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

double median_step(const std::vector<double>& t) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
    return steps.empty() ? 0.0 : median(std::move(steps));
}

/// White noise of the horizontal positions, one sigma per axis, m: from third differences, which are free of constant velocity
/// and acceleration.
double position_noise(const GnssSeries& s) {
    std::vector<double> squares;
    for (std::size_t k = 3; k < s.size(); ++k) {
        if (s.t[k] - s.t[k - 3] > 4.5 * s.step) continue;
        squares.push_back((s.p[k] - 3.0 * s.p[k - 1] + 3.0 * s.p[k - 2] - s.p[k - 3]).head<2>().squaredNorm());
    }
    constexpr double median_of_two = 1.386;  // of the sum of two squares of unit variance
    return squares.size() < 10 ? 0.0 : std::sqrt(median(std::move(squares)) / median_of_two / 20.0);
}

/// The smallest number of neighbours whose slope gives a speed to a decimetre per second; within 5 s.
int reach_of(const GnssSeries& s) {
    constexpr double wanted = 0.12, farthest = 5.0;  // m/s, s
    const double noise = position_noise(s);
    int m = 1;
    const auto sigma = [&] { return noise / (s.step * std::sqrt(m * (m + 1.0) * (2.0 * m + 1.0) / 3.0)); };
    while (s.step > 0.0 && sigma() > wanted && (m + 1) * s.step <= farthest) ++m;
    return m;
}

}  // namespace

double GnssSeries::speed(std::size_t k) const {
    if (has_velocity()) return v[k].head<2>().norm();
    const std::size_t a = k - std::min(k, static_cast<std::size_t>(reach));
    const std::size_t b = std::min(k + static_cast<std::size_t>(reach), size() - 1);
    const double n = static_cast<double>(b - a + 1);
    double mean_t = 0.0;
    for (std::size_t i = a; i <= b; ++i) mean_t += (t[i] - t[k]) / n;
    Eigen::Vector2d moved = Eigen::Vector2d::Zero();
    double spread = 0.0;
    for (std::size_t i = a; i <= b; ++i) {
        const double dt = t[i] - t[k] - mean_t;
        moved += dt * (p[i] - p[k]).head<2>();
        spread += dt * dt;
    }
    return spread > 0.0 ? moved.norm() / spread : 0.0;
}

ImuSeries imu_series(const std::vector<ImuSample>& samples, ImuKind kind, Time origin) {
    return imu_series(
        samples.size(), [&](std::size_t i) { return samples[i]; }, kind, origin);
}

ImuSeries imu_series(std::size_t count, const std::function<ImuSample(std::size_t)>& sample_at, ImuKind kind, Time origin) {
    ImuSeries s;
    s.t.reserve(count);
    s.w.reserve(count);
    s.f.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const ImuSample sample = sample_at(i);
        const double t = (sample.time - origin).seconds();
        if (!sample.gyro.allFinite() || !sample.accel.allFinite()) continue;
        if (!s.t.empty() && t <= s.t.back()) continue;
        s.t.push_back(t);
        s.w.push_back(sample.gyro);
        s.f.push_back(sample.accel);
    }
    s.step = median_step(s.t);
    if (kind == ImuKind::Increments) {
        for (std::size_t i = s.size(); i-- > 0;) {
            const double dt = i > 0 ? std::min(s.t[i] - s.t[i - 1], 3.0 * s.step) : s.step;
            if (dt > 0.0) {
                s.w[i] /= dt;
                s.f[i] /= dt;
            }
        }
    }
    return s;
}

GnssSeries gnss_series(const std::vector<GnssFix>& fixes, Time origin) {
    GnssSeries s;
    const earth::Earth earth;
    Geodetic first{};
    for (const GnssFix& fix : fixes) {
        const double t = (fix.time - origin).seconds();
        Geodetic position = fix.position;
        if (!std::isfinite(position.lat) || !std::isfinite(position.lon) || fix.fix == FixType::None) continue;
        if (!s.t.empty() && t <= s.t.back()) continue;
        if (!std::isfinite(position.h)) position.h = s.t.empty() ? 0.0 : first.h;
        else s.has_height = true;
        if (s.t.empty()) first = position;
        s.t.push_back(t);
        s.p.push_back(earth::ned_difference(earth, position, first));
        s.v.push_back(fix.velocity_n);
    }
    s.lat = first.lat;
    s.h = first.h;
    s.step = median_step(s.t);
    const auto has = [](const Eigen::Vector3d& v) { return std::isfinite(v.x()) && std::isfinite(v.y()); };
    const auto given = std::count_if(s.v.begin(), s.v.end(), has);
    if (2 * given < std::ssize(s.v)) {
        s.v.clear();
        s.reach = reach_of(s);
        return s;
    }
    // A few epochs without velocity are omitted completely: the studies require one time axis.
    std::size_t kept = 0;
    for (std::size_t k = 0; k < s.size(); ++k) {
        if (!has(s.v[k])) continue;
        s.t[kept] = s.t[k];
        s.p[kept] = s.p[k];
        s.v[kept] = s.v[k];
        if (!std::isfinite(s.v[kept].z())) s.v[kept].z() = 0.0;
        ++kept;
    }
    s.t.resize(kept);
    s.p.resize(kept);
    s.v.resize(kept);
    return s;
}

std::size_t index_before(const std::vector<double>& times, double t) {
    const auto after = std::upper_bound(times.begin(), times.end(), t);
    return after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
}

}  // namespace schuler::inspect::detail
