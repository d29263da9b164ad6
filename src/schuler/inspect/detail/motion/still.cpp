#include "schuler/inspect/detail/motion/still.h"

#include "schuler/inspect/detail/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

struct Second {
    double start, stop;
    std::size_t first, last;  // half-open range of samples
    Eigen::Vector3d w_mean, f_mean;
    double w_std, f_std;
    double speed = -1.0;  // largest horizontal GNSS speed around this second; negative: unknown
};

std::vector<Second> seconds_of(const ImuSeries& imu) {
    std::vector<Second> all;
    for (std::size_t first = 0; first < imu.size();) {
        std::size_t last = first;
        while (last < imu.size() && imu.t[last] < imu.t[first] + 1.0) ++last;
        const double n = static_cast<double>(last - first);
        if (n >= 5.0) {
            Second s{imu.t[first], imu.t[last - 1] + imu.step, first, last, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0.0,
                     0.0};
            for (std::size_t i = first; i < last; ++i) {
                s.w_mean += imu.w[i] / n;
                s.f_mean += imu.f[i] / n;
            }
            for (std::size_t i = first; i < last; ++i) {
                s.w_std += (imu.w[i] - s.w_mean).squaredNorm() / n;
                s.f_std += (imu.f[i] - s.f_mean).squaredNorm() / n;
            }
            s.w_std = std::sqrt(s.w_std);
            s.f_std = std::sqrt(s.f_std);
            all.push_back(s);
        }
        first = std::max(last, first + 1);
    }
    return all;
}

void add_speed(std::vector<Second>& seconds, const GnssSeries& gnss) {
    std::size_t k = 0;
    for (Second& s : seconds) {
        while (k < gnss.size() && gnss.t[k] < s.start - 0.6) ++k;
        for (std::size_t j = k; j < gnss.size() && gnss.t[j] <= s.stop + 0.8; ++j) s.speed = std::max(s.speed, gnss.speed(j));
    }
}

// Required calm of a second: a few times that of the quietest seconds of the log, below a stopped engine's or an idling rotor's.
struct Threshold {
    double w_std, f_std;
};

Threshold threshold_of(const std::vector<Second>& seconds) {
    std::vector<double> w, f;
    for (const Second& s : seconds) {
        w.push_back(s.w_std);
        f.push_back(s.f_std);
    }
    return {std::clamp(4.0 * quantile(std::move(w), 0.03), 0.004, 0.06),
            std::clamp(4.0 * quantile(std::move(f), 0.03), 0.08, 0.7)};
}

/// Without the receiver calm seconds are no proof of rest: a steady turn in the air is calm too. A run of them counts where the last known
/// speed before it and the first after it are zero, or where the forces in between explain the change of speed.
bool comes_to_rest(const std::vector<Second>& seconds, std::size_t first, std::size_t last, double still_speed) {
    Eigen::Vector3d f = Eigen::Vector3d::Zero();
    for (std::size_t i = first; i <= last; ++i) f += seconds[i].f_mean / static_cast<double>(last - first + 1);
    constexpr double least = 0.5;  // of the speed: forces also turn with the vehicle
    double impulse = 0.0;
    for (std::size_t i = first; i-- > 0; impulse += (seconds[i].f_mean - f).norm()) {
        if (seconds[i].speed < 0.0) continue;
        if (seconds[i].speed >= still_speed && impulse < least * seconds[i].speed) return false;
        break;
    }
    impulse = 0.0;
    for (std::size_t i = last + 1; i < seconds.size(); impulse += (seconds[i++].f_mean - f).norm()) {
        if (seconds[i].speed < 0.0) continue;
        return seconds[i].speed < still_speed || impulse >= least * seconds[i].speed;
    }
    return true;
}

/// Calm seconds of a vehicle that is not known to move.
std::vector<const Second*> calm_seconds(const std::vector<Second>& seconds, double still_speed) {
    const Threshold quiet = threshold_of(seconds);
    std::vector<const Second*> still;
    for (std::size_t i = 0; i < seconds.size(); ++i) {
        const auto calm = [&](const Second& s) {
            // Zero speed of the receiver makes the vibration of a running engine acceptable.
            const double ease = s.speed >= 0.0 ? 2.0 : 1.0;
            return s.speed < still_speed && s.w_std < ease * quiet.w_std && s.f_std < ease * quiet.f_std;
        };
        if (!calm(seconds[i])) continue;
        std::size_t last = i;
        if (seconds[i].speed < 0.0) {
            while (last + 1 < seconds.size() && seconds[last + 1].speed < 0.0 && calm(seconds[last + 1])) ++last;
            if (!comes_to_rest(seconds, i, last, still_speed)) {
                i = last;
                continue;
            }
        }
        for (; i < last; ++i) still.push_back(&seconds[i]);
        still.push_back(&seconds[i]);
    }
    return still;
}

}  // namespace

StillPeriods still_periods(const ImuSeries& imu, const GnssSeries& gnss) {
    StillPeriods result;
    std::vector<Second> seconds = seconds_of(imu);
    if (seconds.empty()) return result;
    add_speed(seconds, gnss);
    // Receivers report a few decimetres per second at rest; position-only logs more.
    const double still_speed = gnss.has_velocity() ? 0.25 : 0.5;
    std::vector<const Second*> still = calm_seconds(seconds, still_speed);
    if (still.empty()) return result;
    const auto median_rate = [&] {
        Eigen::Vector3d w;
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<double> values;
            for (const Second* s : still) values.push_back(s->w_mean(axis));
            w(axis) = median(std::move(values));
        }
        return w;
    };
    const Eigen::Vector3d rate = median_rate();
    std::erase_if(still, [&](const Second* s) { return (s->w_mean - rate).norm() > 0.01; });  // a slow constant turn is not rest

    std::vector<const Second*> kept, run, longest;
    const auto close = [&] {
        if (!run.empty() && run.back()->stop - run.front()->start >= 1.9) {
            result.intervals.push_back({run.front()->start, run.back()->stop});
            result.total += run.back()->stop - run.front()->start;
            kept.insert(kept.end(), run.begin(), run.end());
            if (run.size() > longest.size()) longest = run;
        }
        run.clear();
    };
    for (const Second* s : still) {
        if (!run.empty() && s->start - run.back()->stop > 0.5) close();
        run.push_back(s);
    }
    close();
    if (kept.empty()) return result;
    still = kept;
    result.w = median_rate();
    std::vector<double> norms;
    for (const Second* s : still) norms.push_back(s->f_mean.norm());
    result.f_norm = median(std::move(norms));
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Second* s : longest) values.push_back(s->f_mean(axis));
        result.f(axis) = median(std::move(values));
    }
    return result;
}

NoiseLevel noise_level(const ImuSeries& imu) {
    NoiseLevel level;
    const std::vector<Second> seconds = seconds_of(imu);
    if (seconds.empty()) return level;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> gyro, accel;
        for (const Second& s : seconds) {
            double w2 = 0.0, f2 = 0.0;
            for (std::size_t i = s.first + 2; i < s.last; ++i) {
                w2 += std::pow(imu.w[i](axis) - 2.0 * imu.w[i - 1](axis) + imu.w[i - 2](axis), 2);
                f2 += std::pow(imu.f[i](axis) - 2.0 * imu.f[i - 1](axis) + imu.f[i - 2](axis), 2);
            }
            // The second difference of white noise has six times its variance.
            const double n = 6.0 * static_cast<double>(s.last - s.first - 2);
            gyro.push_back(std::sqrt(w2 / n));
            accel.push_back(std::sqrt(f2 / n));
        }
        level.gyro(axis) = quantile(std::move(gyro), 0.1) * std::sqrt(imu.step);
        level.accel(axis) = quantile(std::move(accel), 0.1) * std::sqrt(imu.step);
    }
    return level;
}

std::string text_of(const std::vector<StillPeriods::Interval>& intervals, double origin) {
    std::string text;
    for (std::size_t i = 0; i < intervals.size() && i < 6; ++i) {
        text += fmt::format("{}{} to {} s", i > 0 ? ", " : "", std::lround(intervals[i].start - origin),
                            std::lround(intervals[i].stop - origin));
    }
    if (intervals.size() > 6) text += fmt::format(", ... ({} in all)", intervals.size());
    return text;
}

}  // namespace schuler::inspect::detail
