#include "schuler/fusion/faults/height_faults.h"

#include "schuler/earth/gravity.h"
#include "schuler/math/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace schuler::fusion {
namespace {

/// Values at times, in order.
struct Series {
    std::vector<double> t, x;

    [[nodiscard]] std::pair<std::size_t, std::size_t> within(double from, double to) const {
        return {static_cast<std::size_t>(std::ranges::lower_bound(t, from) - t.begin()),
                static_cast<std::size_t>(std::ranges::upper_bound(t, to) - t.begin())};
    }
    [[nodiscard]] double mean(double from, double to) const {
        const auto [a, b] = within(from, to);
        double sum = 0.0;
        for (std::size_t i = a; i < b; ++i) sum += x[i] / static_cast<double>(b - a);
        return b > a ? sum : not_given;
    }
    /// Second derivative of the parabola through the values of a window; absent with fewer than five.
    [[nodiscard]] double bend(double from, double to) const {
        const auto [a, b] = within(from, to);
        if (b < a + 5) return not_given;
        Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
        Eigen::Vector3d y = Eigen::Vector3d::Zero();
        for (std::size_t i = a; i < b; ++i) {
            const double s = t[i] - 0.5 * (from + to);
            const Eigen::Vector3d h(1.0, s, 0.5 * s * s);
            N += h * h.transpose();
            y += (x[i] - x[a]) * h;
        }
        return N.ldlt().solve(y).z();
    }
};

struct Heights {
    Series gnss, baro, force;  ///< m, m, m/s^2: magnitude of the specific force
    std::vector<std::size_t> index;
    double gravity = 9.80665;

    Heights(const Recording& r, const filter::ImuTimeline& imu, const earth::Earth& earth) {
        const Time zero = r.gnss.front().time;
        for (std::size_t i = 0; i < r.gnss.size(); ++i) {
            const GnssFix& f = r.gnss[i];
            if (f.fix == FixType::None || !std::isfinite(f.position.h) || !std::isfinite(f.position.lat)) continue;
            if (gnss.t.empty()) gravity = earth::gravity_down(earth.gravity, f.position.lat, f.position.h);
            gnss.t.push_back((f.time - zero).seconds() - f.position_age);
            gnss.x.push_back(f.position.h);
            index.push_back(i);
        }
        for (const BaroSample& b : r.baro) {
            if (!std::isfinite(b.height)) continue;
            baro.t.push_back((b.time - zero).seconds());
            baro.x.push_back(b.height);
        }
        for (const ImuIncrement& i : imu.increments) {
            force.t.push_back((i.time - zero).seconds() - 0.5 * i.dt);
            force.x.push_back(i.dv.norm() / i.dt);
        }
    }

    /// RMS deviation of the vertical accelerations of receiver and barometer from those of the specific force; absent if there are too few.
    [[nodiscard]] std::optional<std::pair<double, double>> misfit(double from, double to) const {
        constexpr double half = 2.0, step = 1.0;  // s
        std::vector<double> by_gnss, by_baro;
        for (double t = from; t <= to; t += step) {
            const double felt = force.mean(t - half, t + half) - gravity;
            const double g = gnss.bend(t - half, t + half) - felt, b = baro.bend(t - half, t + half) - felt;
            if (!std::isfinite(g) || !std::isfinite(b)) continue;
            by_gnss.push_back(g);
            by_baro.push_back(b);
        }
        constexpr std::size_t least = 8;
        if (by_gnss.size() < least) return std::nullopt;
        const auto rms = [](const std::vector<double>& v) {  // about the median, which contains tilt and bias
            const double middle = math::median(v);
            double sum = 0.0;
            for (const double x : v) sum += (x - middle) * (x - middle) / static_cast<double>(v.size());
            return std::sqrt(sum);
        };
        return std::pair{rms(by_gnss), rms(by_baro)};
    }
};

}  // namespace

std::vector<bool> heights_off_barometer(const Recording& recording, const filter::ImuTimeline& imu, const earth::Earth& earth) {
    std::vector<bool> off;
    if (recording.gnss.size() < 20 || recording.baro.size() < 20 || imu.increments.size() < 100) return off;
    const Heights heights(recording, imu, earth);
    const std::size_t n = heights.index.size();
    Series apart;
    std::vector<double> height;
    std::vector<std::size_t> place;
    for (std::size_t k = 0; k < n; ++k) {
        const double t = heights.gnss.t[k], b = heights.baro.mean(t - 0.5, t + 0.5);
        if (!std::isfinite(b)) continue;
        apart.t.push_back(t);
        apart.x.push_back(heights.gnss.x[k] - b);
        height.push_back(b);
        place.push_back(k);
    }
    if (apart.t.size() < 20) return off;
    constexpr double around = 300.0, least = 10.0, sigmas = 6.0, of_height = 0.05;  // s, m
    std::vector<double> departure(apart.t.size()), allowed(apart.t.size());
    double usual = 0.0;
    {
        std::vector<double> sizes(apart.t.size());
        double level = 0.0, level_height = 0.0, until = -std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < apart.t.size(); ++k) {
            if (apart.t[k] >= until) {  // a common median over an interval: it hardly changes
                const auto [a, b] = apart.within(apart.t[k] - around, apart.t[k] + around);
                const auto part = [&](const std::vector<double>& v) {
                    return math::median({v.begin() + static_cast<std::ptrdiff_t>(a), v.begin() + static_cast<std::ptrdiff_t>(b)});
                };
                level = part(apart.x);
                level_height = part(height);
                until = apart.t[k] + 0.05 * around;
            }
            departure[k] = apart.x[k] - level;
            allowed[k] = of_height * std::abs(height[k] - level_height);
            sizes[k] = std::abs(departure[k]);
        }
        usual = 1.4826 * math::median(std::move(sizes));
    }
    for (double& a : allowed) a += std::max(least, sigmas * usual);
    off.assign(recording.gnss.size(), false);
    std::size_t left_out = 0;
    constexpr double pause = 10.0, onset = 20.0, clearly = 0.6, margin = 3.0;  // s, s, 1, s
    for (std::size_t k = 0; k < departure.size(); ++k) {
        if (std::abs(departure[k]) <= allowed[k]) continue;
        std::size_t first = k, last = k;
        for (std::size_t i = k; i < departure.size() && apart.t[i] - apart.t[last] < pause; ++i)
            if (std::abs(departure[i]) > allowed[i]) last = i;
        k = last;
        const double begin = apart.t[first], end = apart.t[last];
        while (first > 0 && begin - apart.t[first - 1] < onset && std::abs(departure[first - 1]) > 0.25 * allowed[first - 1])
            --first;
        while (last + 1 < departure.size() && apart.t[last + 1] - end < onset &&
               std::abs(departure[last + 1]) > 0.25 * allowed[last + 1])
            ++last;
        const auto misfit = heights.misfit(apart.t[first] - margin, apart.t[last] + margin);
        if (!misfit || misfit->second > clearly * misfit->first) continue;
        for (std::size_t i = first; i <= last; ++i) {
            left_out += off[heights.index[place[i]]] ? 0 : 1;
            off[heights.index[place[i]]] = true;
        }
    }
    if (left_out == 0 || 3 * left_out > recording.gnss.size()) off.clear();
    return off;
}

void screen_heights(FixScreen& screen, const Recording& recording, const filter::ImuTimeline& imu, const Settings& settings,
                    Time origin, WarningLog& warnings) {
    if (!settings.baro.use || settings.integrity.use || settings.constraints.gate_probability <= 0.0) return;
    screen.height = heights_off_barometer(recording, imu, settings.earth);
    const auto first = std::ranges::find(screen.height, true);
    if (first == screen.height.end()) return;
    warnings.add(
        "gnss.height_off",
        fmt::format(
            "{} heights, the first {:.1f} s after the first fix, left the barometer's by metres that the inertial unit did not feel; they and "
            "their vertical velocities were left out",
            std::ranges::count(screen.height, true),
            (recording.gnss[static_cast<std::size_t>(first - screen.height.begin())].time - origin).seconds()));
}

}  // namespace schuler::fusion
