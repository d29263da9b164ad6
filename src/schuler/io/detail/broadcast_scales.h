// Scaling of numbers in navigation messages. Private to the readers.
#pragma once

#include "schuler/core/time.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/system_time.h"
#include "schuler/io/detail/bits.h"

#include <array>
#include <cmath>
#include <numbers>

namespace schuler::io::detail {

/// The next bits times a power of two: two's complement, unsigned, and semicircles as rad.
inline double scaled(Bits& bits, std::size_t count, int exponent) {
    return std::ldexp(static_cast<double>(bits.take_signed(count)), exponent);
}
inline double scaled_unsigned(Bits& bits, std::size_t count, int exponent) {
    return std::ldexp(static_cast<double>(bits.take(count)), exponent);
}
inline double angle(Bits& bits, std::size_t count, int exponent) { return std::numbers::pi * scaled(bits, count, exponent); }

/// Common order and scales of GPS, QZSS and Galileo: the orbit in its plane, then the orientation of the plane.
inline void orbit_in_plane(Bits& b, gnss::KeplerEphemeris& k) {
    k.crs = scaled(b, 16, -5), k.delta_n = angle(b, 16, -43), k.m0 = angle(b, 32, -31);
    k.cuc = scaled(b, 16, -29), k.e = scaled_unsigned(b, 32, -33), k.cus = scaled(b, 16, -29);
    k.sqrt_a = scaled_unsigned(b, 32, -19);
}
inline void orbit_plane(Bits& b, gnss::KeplerEphemeris& k) {
    k.cic = scaled(b, 16, -29), k.omega0 = angle(b, 32, -31), k.cis = scaled(b, 16, -29), k.i0 = angle(b, 32, -31);
    k.crc = scaled(b, 16, -5), k.omega = angle(b, 32, -31), k.omega_dot = angle(b, 24, -43);
}
inline void clock_of_gps(Bits& b, gnss::KeplerEphemeris& k) {
    k.af2 = scaled(b, 8, -55), k.af1 = scaled(b, 16, -43), k.af0 = scaled(b, 22, -31);
}
/// The eight Klobuchar coefficients, as transmitted by GPS, QZSS and BeiDou.
inline gnss::KlobucharCoefficients klobuchar_of(Bits& b) {
    gnss::KlobucharCoefficients c;
    constexpr std::array<int, 4> alpha = {-30, -27, -24, -24}, beta = {11, 14, 16, 16};
    for (std::size_t i = 0; i < 4; ++i) c.alpha[i] = scaled(b, 8, alpha[i]);
    for (std::size_t i = 0; i < 4; ++i) c.beta[i] = scaled(b, 8, beta[i]);
    return c;
}

/// Galileo health as packed in RINEX: validity and health of E1-B, of E5a (not transmitted in I/NAV), of E5b.
inline int galileo_health(int valid_e1, int health_e1, int valid_e5b, int health_e5b) {
    return valid_e1 | health_e1 << 1 | valid_e5b << 6 | health_e5b << 7;
}

/// The same of E5a alone, which is all that F/NAV has.
inline int galileo_health_of_e5a(int valid, int health) { return valid << 3 | health << 4; }

/// GPS accuracy index to metres [ISGPS200:20.3.3.3.1.3]; 15 means no guarantee.
inline double gps_accuracy(int index) {
    constexpr std::array<double, 15> metres = {2.0,  2.8,   4.0,   5.7,   8.0,    11.3,   16.0,  32.0,
                                               64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0, 4096.0};
    return index >= 0 && index < 15 ? metres[static_cast<std::size_t>(index)] : 8192.0;
}

/// Galileo signal-in-space accuracy [GalileoICD:table 89], m; -1: no guarantee.
inline double galileo_accuracy(int index) {
    if (index < 50) return 0.01 * index;
    if (index < 75) return 0.5 + 0.02 * (index - 50);
    if (index < 100) return 1.0 + 0.04 * (index - 75);
    return index <= 125 ? 2.0 + 0.16 * (index - 100) : -1.0;
}

/// GPS time from a truncated week count of a system, nearest to now; seconds on the system's own scale.
inline Time from_week_count(gnss::System system, int count, int wrap, double seconds, Time now) {
    const int now_week = gnss::week_second(now).week;
    int week = count + gnss::first_week_of(system);
    week += static_cast<int>(std::lround(static_cast<double>(now_week - week) / wrap)) * wrap;
    return Time::from_gps(week, seconds) + gnss::lag_of(system);
}

}  // namespace schuler::io::detail
