// Numbers as navigation messages scale them. Private to the readers.
#pragma once

#include "schuler/core/time.h"
#include "schuler/io/detail/bits.h"

#include <array>
#include <cmath>
#include <numbers>

namespace schuler::io::detail {

/// The next bits times two to the exponent: two's complement, unsigned, and half turns as rad.
inline double scaled(Bits& bits, std::size_t count, int exponent) {
    return std::ldexp(static_cast<double>(bits.take_signed(count)), exponent);
}
inline double scaled_unsigned(Bits& bits, std::size_t count, int exponent) {
    return std::ldexp(static_cast<double>(bits.take(count)), exponent);
}
inline double angle(Bits& bits, std::size_t count, int exponent) { return std::numbers::pi * scaled(bits, count, exponent); }

/// Accuracy index of GPS to metres [ISGPS200:20.3.3.3.1.3]; 15 promises nothing.
inline double gps_accuracy(int index) {
    constexpr std::array<double, 15> metres = {2.0,  2.8,   4.0,   5.7,   8.0,    11.3,   16.0,  32.0,
                                               64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0, 4096.0};
    return index >= 0 && index < 15 ? metres[static_cast<std::size_t>(index)] : 8192.0;
}

/// Galileo's signal-in-space accuracy [GalileoICD:table 89], m; -1: no promise.
inline double galileo_accuracy(int index) {
    if (index < 50) return 0.01 * index;
    if (index < 75) return 0.5 + 0.02 * (index - 50);
    if (index < 100) return 1.0 + 0.04 * (index - 75);
    return index <= 125 ? 2.0 + 0.16 * (index - 100) : -1.0;
}

/// Time of a count of weeks that wraps, next to now; `first_week` is the GPS week of count zero.
inline Time from_week_count(int count, int wrap, int first_week, double seconds, Time now) {
    constexpr std::int64_t week_ns = 604'800'000'000'000;
    const auto now_week = static_cast<int>(now.ns / week_ns);
    int week = count + first_week;
    week += static_cast<int>(std::lround(static_cast<double>(now_week - week) / wrap)) * wrap;
    return Time::from_gps(week, seconds);
}

}  // namespace schuler::io::detail
