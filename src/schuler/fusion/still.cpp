#include "schuler/fusion/still.h"

#include "schuler/earth/earth.h"
#include "schuler/filter/stream/still_slots.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

using Slot = StillSlot;
constexpr double slot_length = StillSlot::length;
constexpr double no_limit = std::numeric_limits<double>::infinity(), slow_mean = 0.1;  // m/s

std::vector<Slot> make_slots(const ImuTimeline& imu) {
    std::vector<Slot> slots;
    if (imu.increments.empty()) return slots;
    const Time start = imu.increments.front().time;
    std::size_t bridge = 0;
    for (std::size_t i = 0; i < imu.increments.size(); ++i) {
        const ImuIncrement& inc = imu.increments[i];
        while (bridge < imu.bridges.size() && imu.bridges[bridge].last < i) ++bridge;
        const auto k = static_cast<std::size_t>((inc.time - start).seconds() / slot_length);
        while (slots.size() <= k) {
            Slot s;
            s.end = start + Duration::from_seconds(slot_length * static_cast<double>(slots.size() + 1));
            slots.push_back(s);
        }
        if (bridge < imu.bridges.size() && imu.bridges[bridge].first <= i) continue;  // interpolated: not a real standstill
        slots[k].add(inc);
    }
    return slots;
}

/// GNSS speed per slot: from velocities, or else from differences of precise positions.
void add_speeds(std::vector<Slot>& slots, const Recording& recording, const std::vector<Event>& events,
                const Settings& settings) {
    if (slots.empty()) return;
    const Time start = slots.front().end - Duration::from_seconds(slot_length);
    const auto set = [&](Time t, double speed) {
        const double k = (t - start).seconds() / slot_length;
        if (k < 0.0 || k >= static_cast<double>(slots.size())) return;
        slots[static_cast<std::size_t>(k)].add_speed(speed);
    };
    const GnssFix* last = nullptr;
    Time last_time{};
    for (const Event& e : events) {
        if (e.withheld) {
            last = nullptr;
            continue;
        }
        if (e.kind == MeasurementKind::GnssVelocity && (e.components & 3) == 3) {
            const double speed = recording.gnss[e.index].velocity_n.head<2>().norm();
            set(e.valid, speed);
        } else if (e.kind == MeasurementKind::GnssPosition && (e.components & 3) == 3) {
            const GnssFix& fix = recording.gnss[e.index];
            const double sigma = fix.std_position.head<2>().norm();
            if (fix.velocity_n.head<2>().allFinite() || !(sigma > 0.0 && sigma < 0.1)) continue;
            const double dt = last != nullptr ? (e.valid - last_time).seconds() : 0.0;
            if (dt > 0.05 && dt < 2.5) {
                const double speed = earth::ned_difference(settings.earth, fix.position, last->position).head<2>().norm() / dt;
                for (double t = 0.0; t <= dt; t += slot_length) set(last_time + Duration::from_seconds(t), speed);
            }
            last = &fix;
            last_time = e.valid;
        }
    }
}

double quantile(std::vector<double>& x, double q) {
    const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(x.size() - 1));
    std::nth_element(x.begin(), x.begin() + k, x.end());
    return x[static_cast<std::size_t>(k)];
}

/// Positions with metre-level noise show a low speed only over some seconds: uses the means of ten seconds before and after.
/// False if not required, or not possible.
bool add_slow_speeds(std::vector<Slot>& slots, const Recording& recording, const std::vector<Event>& events,
                     const Settings& settings) {
    constexpr double half = 10.0, sharp = 0.1;  // s, m/s
    struct Point {
        double t;
        Eigen::Vector2d p;
    };
    std::vector<Point> points;
    const GnssFix* first = nullptr;
    for (const Event& e : events) {
        if (e.withheld || e.kind != MeasurementKind::GnssPosition || (e.components & 3) != 3) continue;
        const GnssFix& fix = recording.gnss[e.index];
        if (fix.velocity_n.head<2>().allFinite()) return false;  // more accurate
        if (first == nullptr) first = &fix;
        points.push_back({(e.valid - slots.front().end).seconds() + slot_length,
                          earth::ned_difference(settings.earth, fix.position, first->position).head<2>()});
    }
    if (points.size() < 20) return false;
    std::vector<double> second;
    for (std::size_t i = 2; i < points.size(); ++i)
        second.push_back((points[i].p - 2.0 * points[i - 1].p + points[i - 2].p).cwiseAbs().maxCoeff());
    const double white =
        quantile(second, 0.5) / 1.05 / std::sqrt(6.0);  // the larger of two normal deviates' magnitudes has the median 1.05 sigma
    bool told = false;
    std::size_t low = 0, middle = 0, high = 0;
    Eigen::Vector2d before = Eigen::Vector2d::Zero(), after = before;
    for (std::size_t k = 0; k < slots.size(); ++k) {
        const double t = slot_length * (static_cast<double>(k) + 0.5);
        for (; high < points.size() && points[high].t < t + half; ++high) after += points[high].p;
        for (; middle < high && points[middle].t < t; ++middle) {
            after -= points[middle].p;
            before += points[middle].p;
        }
        for (; low < middle && points[low].t < t - half; ++low) before -= points[low].p;
        const auto n = static_cast<double>(middle - low), m = static_cast<double>(high - middle);
        if (n < 5.0 || m < 5.0) continue;
        if (points[middle - 1].t - points[low].t < 0.8 * half || points[high - 1].t - points[middle].t < 0.8 * half) continue;
        if (white * std::sqrt(1.0 / n + 1.0 / m) / half > sharp) continue;
        slots[k].add_speed((after / m - before / n).norm() / half);
        told = true;
    }
    return told;
}

struct VelocityPoint {
    double t;           ///< s, from the start of the first slot
    Eigen::Vector2d v;  ///< m/s, north and east
    double variance;    ///< m^2/s^2, sum of both
};

std::vector<VelocityPoint> horizontal_velocities(const std::vector<Slot>& slots, const Recording& recording,
                                                 const std::vector<Event>& events) {
    std::vector<VelocityPoint> points;
    for (const Event& e : events) {
        if (e.withheld || e.kind != MeasurementKind::GnssVelocity || (e.components & 3) != 3) continue;
        const GnssFix& fix = recording.gnss[e.index];
        const double t = (e.valid - slots.front().end).seconds() + slot_length;
        points.push_back({t, fix.velocity_n.head<2>(), fix.std_velocity.head<2>().squaredNorm()});
    }
    return points;
}

/// Noise of a component of the velocities as they show it where they vary least, m/s: right if a tenth of the log is at rest, else too
/// large. Stated sigmas may be missing or wrong.
double velocity_noise(const std::vector<VelocityPoint>& points) {
    std::vector<double> second;
    for (std::size_t i = 2; i < points.size(); ++i)
        second.push_back((points[i].v - 2.0 * points[i - 1].v + points[i - 2].v).cwiseAbs().maxCoeff());
    // the larger of two normal deviates' magnitudes is below 0.407 sigma in a tenth of all cases
    return second.size() < 20 ? no_limit : quantile(second, 0.1) / 0.407 / std::sqrt(6.0);
}

/// Velocities that are individually too noisy to detect rest: the magnitudes of their means within `half` (s) on each side, if those
/// are accurate to `sharp` (m/s).
void set_mean_speeds(std::vector<Slot>& slots, const std::vector<VelocityPoint>& points, double half, double sharp) {
    std::size_t low = 0, high = 0;
    for (std::size_t k = 0; k < slots.size(); ++k) {
        const double t = slot_length * (static_cast<double>(k) + 0.5);
        while (high < points.size() && points[high].t <= t + half) ++high;
        while (low < high && points[low].t < t - half) ++low;
        slots[k].speed = not_given;
        const auto n = static_cast<double>(high - low);
        if (n < 5.0 || points[high - 1].t - points[low].t < 0.8 * half) continue;
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        double variance = 0.0;
        for (std::size_t i = low; i < high; ++i) {
            sum += points[i].v;
            variance += points[i].variance;
        }
        if (std::sqrt(variance) / n < sharp) slots[k].speed = sum.norm() / n;
    }
}

/// Speeds of a receiver with noisy velocities, as means over the shortest sufficient time. False if there is none.
bool set_smoothed_speeds(std::vector<Slot>& slots, const Recording& recording, const std::vector<Event>& events) {
    constexpr double sharp = 0.03, shortest = 0.5, longest = 5.0;  // m/s, s, s
    std::vector<VelocityPoint> points = horizontal_velocities(slots, recording, events);
    if (points.size() < 20) return false;
    const double noise = velocity_noise(points), span = points.back().t - points.front().t;
    const double interval = span / static_cast<double>(points.size() - 1);
    const double half = std::max({shortest, interval * noise * noise / (sharp * sharp), 2.5 * interval});
    if (!(half < longest)) return false;
    for (VelocityPoint& p : points) p.variance = 2.0 * noise * noise;
    set_mean_speeds(slots, points, half, 2.0 * sharp);
    return true;
}

/// A quarter above the variation of the slots that are calm according to their speeds; zero if there are too few.
StillThresholds calm_thresholds(const std::vector<Slot>& slots) {
    std::vector<double> force, rate;
    for (std::size_t i = 0; i < slots.size(); ++i) {
        const Slot& s = slots[i];
        if (!std::isfinite(s.speed) || !std::isfinite(s.force_std)) continue;
        bool calm = s.speed < 0.1;
        for (std::size_t k = i >= 5 ? i - 5 : 0; calm && k <= std::min(slots.size() - 1, i + 5); ++k)
            calm = !(slots[k].speed > 0.1);
        if (calm) {
            force.push_back(s.force_std);
            rate.push_back(s.rate_std);
        }
    }
    if (force.size() < 15) return {};
    return {false, 1.25 * quantile(force, 0.95), 1.25 * quantile(rate, 0.95)};
}

/// `share` of the moving slots may be classified as standstill, because their speeds do not resolve short stops.
StillThresholds learn(const std::vector<Slot>& slots, double share) {
    StillThresholds t = calm_thresholds(slots);
    if (!(t.force_std > 0.0)) return {};
    std::vector<const Slot*> moving;
    for (const Slot& s : slots)
        if (s.speed > 0.5 && std::isfinite(s.force_std)) moving.push_back(&s);
    // Reduce until practically no moving slot passes; give up if the two cannot be separated.
    const double allowed = share * static_cast<double>(moving.size());
    for (int i = 0; i < 12; ++i) {
        const auto wrong = std::count_if(moving.begin(), moving.end(),
                                         [&](const Slot* s) { return s->force_std < t.force_std && s->rate_std < t.rate_std; });
        if (static_cast<double>(wrong) <= allowed) {
            t.learnt = true;
            return t;
        }
        t.force_std *= 0.85;
        t.rate_std *= 0.85;
    }
    return {};
}

/// Standstill windows; with a `limit` (m/s) only if a speed is known and below it.
std::vector<StillWindow> windows_of(const std::vector<Slot>& slots, const StillThresholds& thresholds, const Settings& settings,
                                    double limit) {
    std::vector<StillWindow> windows;
    // Aircraft hover and ships drift without the IMU sensing it: standstill is accepted only before the first motion.
    const bool until_first_motion = settings.vehicle == VehicleKind::Air || settings.vehicle == VehicleKind::Hand;
    if (settings.vehicle == VehicleKind::Ship) return windows;
    const double largest_rate = largest_still_rate(settings.vehicle);
    bool moved = false;
    for (std::size_t i = 0; i < slots.size(); ++i) {
        const Slot& s = slots[i];
        moved = moved || s.speed > 1.0;
        if (until_first_motion && moved) break;
        if (std::isfinite(limit) && !(s.speed < limit)) continue;
        if (is_still(slots, i, thresholds, largest_rate)) windows.push_back(s.window());
    }
    return windows;
}

}  // namespace

StillReport find_still(const ImuTimeline& imu, const Recording& recording, const std::vector<Event>& events,
                       const Settings& settings) {
    StillReport report;
    std::vector<Slot> slots = make_slots(imu);
    for (std::size_t i = 0; i < slots.size(); ++i) add_statistics(slots, i, imu.median_dt);
    add_speeds(slots, recording, events, settings);
    const bool coarse = add_slow_speeds(slots, recording, events, settings);
    report.thresholds = learn(slots, coarse ? 0.25 : 0.001);
    if (!report.thresholds.learnt && !coarse && !uses_ranges(settings.coupling) && !slots.empty() &&
        set_smoothed_speeds(slots, recording, events))
        report.thresholds = learn(slots, 0.001);
    if (report.thresholds.learnt) report.windows = windows_of(slots, report.thresholds, settings, no_limit);
    // If the variation is not sufficient, ranges alone can be: a stop shown by their speeds.
    if (report.windows.empty() && uses_ranges(settings.coupling) && !recording.ranges.empty() && !slots.empty()) {
        set_mean_speeds(slots, horizontal_velocities(slots, recording, events), 10.0, 0.05);
        const StillThresholds calm = calm_thresholds(slots);
        if (calm.force_std > 0.0) report.windows = windows_of(slots, calm, settings, slow_mean);
    }
    return report;
}

}  // namespace schuler::fusion
