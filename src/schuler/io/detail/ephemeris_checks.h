// Validity checks common to all readers of ephemerides. Private to the readers.
#pragma once

#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/system_time.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

namespace schuler::io::detail {

/// A number that should be an integer; 0 if it is absurd.
[[nodiscard]] inline int whole(double x) { return std::isfinite(x) && std::abs(x) < 1e9 ? static_cast<int>(std::lround(x)) : 0; }

/// The instant nearest to `near` that differs from `wanted` by a whole number of periods.
[[nodiscard]] inline Time nearest_of(std::int64_t wanted_ns, std::int64_t period_ns, Time near) {
    std::int64_t apart = (wanted_ns - near.ns) % period_ns;
    if (apart > period_ns / 2) apart -= period_ns;
    if (apart < -period_ns / 2) apart += period_ns;
    return {near.ns + apart};
}

/// The instant nearest to `near` with these seconds of a system's week.
[[nodiscard]] inline Time nearest_in_week(double seconds_of_week, Time near, gnss::System system = gnss::System::Gps) {
    return nearest_of((Duration::from_seconds(seconds_of_week) + gnss::lag_of(system)).ns, gnss::week_ns, near);
}

/// The instant nearest to `near` with this time of the day in Moscow, three hours ahead of UTC, as used by GLONASS.
[[nodiscard]] inline Time nearest_in_moscow_day(std::int64_t of_day_ns, Time near) {
    constexpr std::int64_t second = 1'000'000'000, hour = 3600 * second;
    const std::int64_t leap = std::int64_t{gps_minus_utc(near.ns / second)} * second;
    return nearest_of(of_day_ns - 3 * hour + leap, 24 * hour, near);
}

/// toe and the time of transmission from seconds of week, nearest to toc: weeks in files are not always correct.
inline void set_times(gnss::KeplerEphemeris& k, double toe, double sent) {
    constexpr double week = static_cast<double>(gnss::week_ns) * 1e-9;
    if (!(std::abs(toe) <= week)) {
        k.sqrt_a = NAN;  // marked invalid
        return;
    }
    k.toe = nearest_in_week(toe, k.toc, k.satellite.system);
    k.transmission = std::abs(sent) <= 2.0 * week ? nearest_in_week(sent, k.toe, k.satellite.system) : k.toe;
}

[[nodiscard]] inline bool is_sound(const gnss::KeplerEphemeris& k) {
    constexpr std::int64_t day = 86'400'000'000'000;
    for (const double x : {k.af0,  k.af1, k.af2, k.e,   k.i0,  k.omega0, k.omega, k.m0,       k.delta_n, k.omega_dot,
                           k.idot, k.cuc, k.cus, k.crc, k.crs, k.cic,    k.cis,   k.accuracy, k.a_rate,  k.delta_n_rate}) {
        if (!std::isfinite(x)) return false;
    }
    const bool angles = std::abs(k.m0) < 10.0 && std::abs(k.omega) < 10.0 && std::abs(k.omega0) < 10.0 && std::abs(k.i0) < 4.0;
    const bool small = std::abs(k.cuc) < 1e-2 && std::abs(k.cus) < 1e-2 && std::abs(k.cic) < 1e-2 && std::abs(k.cis) < 1e-2 &&
                       std::abs(k.crc) < 1e5 && std::abs(k.crs) < 1e5 && std::abs(k.delta_n) < 1e-6 && std::abs(k.idot) < 1e-6 &&
                       std::abs(k.omega_dot) < 1e-6 && std::abs(k.a_rate) < 10.0 && std::abs(k.delta_n_rate) < 1e-9;
    const bool clock = std::abs(k.af0) < 0.1 && std::abs(k.af1) < 1e-6 && std::abs(k.af2) < 1e-9 &&
                       std::abs(k.group_delay[0]) < 1e-5 && std::abs(k.group_delay[1]) < 1e-5 &&
                       std::abs(k.group_delay[2]) < 1e-5;
    return k.sqrt_a > 2000.0 && k.sqrt_a < 10'000.0 && k.e >= 0.0 && k.e < 0.7 && angles && small && clock &&
           std::abs((k.toe - k.toc).ns) <= day;
}

/// Adds an ephemeris unless it is already present; the newest are checked first, because satellites repeat them.
template <class Ephemeris>
void add_new(std::vector<Ephemeris>& all, const Ephemeris& e) {
    const bool known = std::any_of(all.rbegin(), all.rend(), [&](const Ephemeris& o) {
        if constexpr (std::is_same_v<Ephemeris, gnss::KeplerEphemeris>) {
            if (o.iode != e.iode || o.message != e.message) return false;
        }
        return o.satellite == e.satellite && o.toe == e.toe;
    });
    if (!known) all.push_back(e);
}

/// State vectors: GLONASS and SBAS.
template <class Ephemeris>
[[nodiscard]] bool is_sound(const Ephemeris& g) {
    if (!g.position.allFinite() || !g.velocity.allFinite() || !g.acceleration.allFinite()) return false;
    const double r = g.position.norm();
    return r > 1e7 && r < 1e8 && g.velocity.norm() < 1e4 && g.acceleration.norm() < 1.0 && std::abs(g.clock) < 0.1 &&
           std::abs(g.clock_rate) < 1e-6;
}

}  // namespace schuler::io::detail
