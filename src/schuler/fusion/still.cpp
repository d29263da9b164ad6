#include "schuler/fusion/still.h"

#include "schuler/earth/earth.h"

#include <algorithm>
#include <cmath>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

constexpr double slot_length = 0.2;   // s, resolution of the decision
constexpr int reach = 2;              // slots on each side that take part in the statistics (a second in all)

struct Slot {
    Time end;
    double dt = 0.0;
    int n = 0;
    Vector3d rate = Vector3d::Zero(), force = Vector3d::Zero();      // sums, then means
    Vector3d rate2 = Vector3d::Zero(), force2 = Vector3d::Zero();    // sums of squares
    double rate_std = 0.0, force_std = 0.0, rate_norm = 0.0;         // over the slot and its neighbours
    double speed = not_given;                                        // m/s, from GNSS
};

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
        if (bridge < imu.bridges.size() && imu.bridges[bridge].first <= i) continue;   // interpolated: looks still, is not
        Slot& s = slots[k];
        const Vector3d rate = inc.dtheta / inc.dt, force = inc.dv / inc.dt;
        s.dt += inc.dt;
        ++s.n;
        s.rate += rate;
        s.force += force;
        s.rate2 += rate.cwiseAbs2();
        s.force2 += force.cwiseAbs2();
    }
    return slots;
}

/// Standard deviations over a slot and its neighbours; infinite where samples are missing.
void add_statistics(std::vector<Slot>& slots, double median_dt) {
    const int expected = static_cast<int>(0.6 * slot_length / median_dt);
    for (std::size_t i = 0; i < slots.size(); ++i) {
        const std::size_t first = i >= reach ? i - reach : 0, last = std::min(slots.size() - 1, i + reach);
        Vector3d r = Vector3d::Zero(), f = r, r2 = r, f2 = r;
        double n = 0.0;
        bool complete = true;
        for (std::size_t k = first; k <= last; ++k) {
            complete = complete && slots[k].n >= std::max(1, expected);
            n += slots[k].n;
            r += slots[k].rate;
            f += slots[k].force;
            r2 += slots[k].rate2;
            f2 += slots[k].force2;
        }
        Slot& s = slots[i];
        if (!complete || n < 3.0) {
            s.rate_std = s.force_std = s.rate_norm = std::numeric_limits<double>::infinity();
            continue;
        }
        s.rate_std = std::sqrt(std::max(0.0, (r2 / n - (r / n).cwiseAbs2()).sum()));
        s.force_std = std::sqrt(std::max(0.0, (f2 / n - (f / n).cwiseAbs2()).sum()));
        s.rate_norm = (r / n).norm();
    }
}

/// GNSS speed per slot: from velocities, else from differences of precise positions.
void add_speeds(std::vector<Slot>& slots, const Recording& recording, const std::vector<Event>& events, const Settings& settings) {
    if (slots.empty()) return;
    const Time start = slots.front().end - Duration::from_seconds(slot_length);
    const auto set = [&](Time t, double speed) {
        const double k = (t - start).seconds() / slot_length;
        if (k < 0.0 || k >= static_cast<double>(slots.size())) return;
        Slot& s = slots[static_cast<std::size_t>(k)];
        s.speed = std::isfinite(s.speed) ? std::max(s.speed, speed) : speed;
    };
    const GnssFix* last = nullptr;
    Time last_time{};
    for (const Event& e : events) {
        if (e.withheld) {
            last = nullptr;
            continue;
        }
        if (e.kind == AidKind::GnssVelocity && (e.components & 3) == 3) {
            const double speed = recording.gnss[e.index].velocity_n.head<2>().norm();
            set(e.valid, speed);
        } else if (e.kind == AidKind::GnssPosition && (e.components & 3) == 3) {
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

StillThresholds learn(const std::vector<Slot>& slots) {
    std::vector<double> force, rate;
    std::vector<const Slot*> moving;
    for (std::size_t i = 0; i < slots.size(); ++i) {
        const Slot& s = slots[i];
        if (!std::isfinite(s.speed) || !std::isfinite(s.force_std)) continue;
        if (s.speed > 0.5) {
            moving.push_back(&s);
            continue;
        }
        bool calm = s.speed < 0.1;
        for (std::size_t k = i >= 5 ? i - 5 : 0; calm && k <= std::min(slots.size() - 1, i + 5); ++k)
            calm = !(slots[k].speed > 0.1);
        if (calm) {
            force.push_back(s.force_std);
            rate.push_back(s.rate_std);
        }
    }
    StillThresholds t;
    if (force.size() < 15) return t;
    t.force_std = 1.25 * quantile(force, 0.95);
    t.rate_std = 1.25 * quantile(rate, 0.95);
    // Shrink until practically no moving slot passes; give up if the two cannot be told apart.
    const double allowed = 0.001 * static_cast<double>(moving.size());
    for (int i = 0; i < 12; ++i) {
        const auto wrong = std::count_if(moving.begin(), moving.end(), [&](const Slot* s) {
            return s->force_std < t.force_std && s->rate_std < t.rate_std;
        });
        if (static_cast<double>(wrong) <= allowed) {
            t.learnt = true;
            return t;
        }
        t.force_std *= 0.85;
        t.rate_std *= 0.85;
    }
    return {};
}

}  // namespace

StillReport find_still(const ImuTimeline& imu, const Recording& recording, const std::vector<Event>& events,
                       const Settings& settings) {
    StillReport report;
    std::vector<Slot> slots = make_slots(imu);
    add_statistics(slots, imu.median_dt);
    add_speeds(slots, recording, events, settings);
    report.thresholds = learn(slots);
    if (!report.thresholds.learnt) return report;

    // Aircraft hover and ships drift without the IMU noticing: they stand still only before they first move.
    const bool until_first_motion = settings.vehicle == VehicleKind::Air || settings.vehicle == VehicleKind::Hand;
    const bool never = settings.vehicle == VehicleKind::Ship;
    if (never) return report;
    const double max_rate = settings.vehicle == VehicleKind::Car || settings.vehicle == VehicleKind::Static ? 0.2 : 0.5;
    bool moved = false;
    for (std::size_t i = 0; i < slots.size(); ++i) {
        const Slot& s = slots[i];
        moved = moved || s.speed > 1.0;
        if (until_first_motion && moved) break;
        const auto calm = [&](std::size_t k) {
            return slots[k].force_std < report.thresholds.force_std && slots[k].rate_std < report.thresholds.rate_std &&
                   slots[k].rate_norm < max_rate && !(slots[k].speed > 0.3);
        };
        const bool still = s.n > 0 && calm(i) && (i == 0 || calm(i - 1)) && (i + 1 == slots.size() || calm(i + 1));
        if (still) report.windows.push_back({s.end, s.dt, s.rate / s.n, s.force / s.n});
    }
    return report;
}

}  // namespace schuler::fusion
