// Fast decimal output with a fixed number of decimals.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace schuler::io {
namespace detail {

inline constexpr std::array<char, 200> digit_pairs = [] {
    std::array<char, 200> pairs{};
    for (int i = 0; i < 100; ++i) {
        pairs[static_cast<std::size_t>(2 * i)] = static_cast<char>('0' + i / 10);
        pairs[static_cast<std::size_t>(2 * i + 1)] = static_cast<char>('0' + i % 10);
    }
    return pairs;
}();

inline void put_pair(char* out, std::uint64_t two_digits) { std::memcpy(out, digit_pairs.data() + 2 * two_digits, 2); }

/// Exactly Count digits of value < 10^Count.
template <int Count>
inline char* put_digits(char* out, std::uint64_t value) {
    if constexpr (Count == 0) {
        return out;
    } else if constexpr (Count == 1) {
        *out = static_cast<char>('0' + value);
        return out + 1;
    } else if constexpr (Count == 2) {
        put_pair(out, value);
        return out + 2;
    } else if constexpr (Count <= 8) {
        // The halves are independent, so the divisions overlap.
        constexpr int low = Count / 4 * 2 == 0 ? 2 : Count / 4 * 2;
        constexpr std::uint32_t split = low == 2 ? 100 : 10'000;
        const auto v = static_cast<std::uint32_t>(value);
        out = put_digits<Count - low>(out, v / split);
        return put_digits<low>(out, v % split);
    } else {
        constexpr std::uint64_t split = 100'000'000;
        out = put_digits<Count - 8>(out, value / split);
        return put_digits<8>(out, value % split);
    }
}

/// An integer without leading zeros.
inline char* put_integer(char* out, std::uint64_t value) {
    if (value < 10) {
        *out = static_cast<char>('0' + value);
        return out + 1;
    }
    if (value < 100) {
        put_pair(out, value);
        return out + 2;
    }
    if (value < 1000) {
        *out = static_cast<char>('0' + value / 100);
        put_pair(out + 1, value % 100);
        return out + 3;
    }
    char digits[20];
    char* p = digits + 20;
    while (value >= 100) {
        p -= 2;
        put_pair(p, value % 100);
        value /= 100;
    }
    if (value >= 10) {
        p -= 2;
        put_pair(p, value);
    } else {
        *--p = static_cast<char>('0' + value);
    }
    const auto n = static_cast<std::size_t>(digits + 20 - p);
    std::memcpy(out, p, n);
    return out + n;
}

/// Values beyond the fast path: large, infinite.
[[nodiscard]] char* put_unusual(char* out, double value, int decimals);

constexpr std::uint64_t power_of_ten(int n) { return n == 0 ? 1 : 10 * power_of_ten(n - 1); }

}  // namespace detail

/// Largest number of bytes of one number.
inline constexpr std::size_t widest_number = 48;

/// Appends value with Decimals decimals, rounded to the nearest last digit (to one unit of the product value * 10^Decimals in
/// double arithmetic). NaN appends nothing, minus zero is written as zero, and magnitudes above 2^53 / 10^Decimals are
/// written with 17 significant digits. Returns the new end; `out` needs widest_number bytes.
template <int Decimals>
inline char* put_fixed(char* out, double value) {
    constexpr std::uint64_t scale = detail::power_of_ten(Decimals);
    const double scaled = value * static_cast<double>(scale);
    if (!(std::abs(scaled) < 9007199254740992.0)) [[unlikely]]
        return detail::put_unusual(out, value, Decimals);
    const auto n = static_cast<std::int64_t>(std::nearbyint(scaled));
    *out = '-';
    out += n < 0 ? 1 : 0;
    const auto magnitude = static_cast<std::uint64_t>(n < 0 ? -n : n);
    out = detail::put_integer(out, magnitude / scale);
    if constexpr (Decimals > 0) {
        *out++ = '.';
        out = detail::put_digits<Decimals>(out, magnitude % scale);
    }
    return out;
}

/// Appends nanoseconds as seconds: exact, three decimals or as many as needed.
[[nodiscard]] char* put_seconds(char* out, std::int64_t ns);

}  // namespace schuler::io
