// What every reader of ephemerides demands before it believes one. Private to the readers.
#pragma once

#include "schuler/gnss/ephemeris.h"

#include <cmath>

namespace schuler::io::detail {

/// A number that should be whole, as one; 0 where it is absurd.
[[nodiscard]] inline int whole(double x) { return std::isfinite(x) && std::abs(x) < 1e9 ? static_cast<int>(std::lround(x)) : 0; }

/// The instant nearest to `near` that has these seconds of week on a scale that lags GPS time by `lag`.
[[nodiscard]] inline Time nearest_in_week(double seconds_of_week, Time near, Duration lag = {}) {
    constexpr std::int64_t week = 604'800'000'000'000;
    const std::int64_t wanted = Duration::from_seconds(seconds_of_week).ns + lag.ns;
    std::int64_t apart = (wanted - near.ns) % week;
    if (apart > week / 2) apart -= week;
    if (apart < -week / 2) apart += week;
    return {near.ns + apart};
}

/// toe and the time of transmission from seconds of week, next to toc: weeks in files are not always what they should be.
inline void set_times(gnss::KeplerEphemeris& k, double toe, double sent) {
    const Duration lag{k.satellite.system == gnss::System::BeiDou ? std::int64_t{14'000'000'000} : 0};
    constexpr double week = 604'800.0;
    if (!(std::abs(toe) <= week)) {
        k.sqrt_a = NAN;  // not sound
        return;
    }
    k.toe = nearest_in_week(toe, k.toc, lag);
    k.transmission = std::abs(sent) <= 2.0 * week ? nearest_in_week(sent, k.toe, lag) : k.toe;
}

[[nodiscard]] inline bool is_sound(const gnss::KeplerEphemeris& k) {
    constexpr std::int64_t day = 86'400'000'000'000;
    for (const double x : {k.af0, k.af1, k.af2, k.e, k.i0, k.omega0, k.omega, k.m0, k.delta_n, k.omega_dot, k.idot, k.cuc, k.cus,
                           k.crc, k.crs, k.cic, k.cis, k.accuracy}) {
        if (!std::isfinite(x)) return false;
    }
    const bool angles = std::abs(k.m0) < 10.0 && std::abs(k.omega) < 10.0 && std::abs(k.omega0) < 10.0 && std::abs(k.i0) < 4.0;
    const bool small = std::abs(k.cuc) < 1e-2 && std::abs(k.cus) < 1e-2 && std::abs(k.cic) < 1e-2 && std::abs(k.cis) < 1e-2 &&
                       std::abs(k.crc) < 1e5 && std::abs(k.crs) < 1e5 && std::abs(k.delta_n) < 1e-6 && std::abs(k.idot) < 1e-6 &&
                       std::abs(k.omega_dot) < 1e-6;
    const bool clock = std::abs(k.af0) < 0.1 && std::abs(k.af1) < 1e-6 && std::abs(k.af2) < 1e-9 &&
                       std::abs(k.group_delay[0]) < 1e-5 && std::abs(k.group_delay[1]) < 1e-5;
    return k.sqrt_a > 2000.0 && k.sqrt_a < 10'000.0 && k.e >= 0.0 && k.e < 0.7 && angles && small && clock &&
           std::abs((k.toe - k.toc).ns) <= day;
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
