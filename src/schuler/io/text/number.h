// Decimal numbers in text: to the nearest double, and exactly to nanoseconds.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

namespace schuler::io {

enum class TimeUnit { Seconds, Milliseconds, Microseconds, Nanoseconds };

/// A decimal number as written: sign, up to 19 digits, power of ten.
struct Decimal {
    std::uint64_t digits = 0;
    int count = 0;     ///< digits seen, leading zeros included; above 19 `digits` has overflowed
    int exponent = 0;  ///< value = digits * 10^exponent
    bool negative = false;
};

namespace detail {

/// True if these eight bytes are all ASCII digits '0'..'9'.
inline bool are_eight_digits(std::uint64_t bytes) {
    // The high nibble of a digit is 3 and stays 3 when 6 is added to the low nibble.
    constexpr std::uint64_t high = 0xf0f0f0f0f0f0f0f0U;
    return ((bytes & high) == 0x3030303030303030U) && (((bytes + 0x0606060606060606U) & high) == 0x3030303030303030U);
}

/// Their value, the first byte in memory being the most significant (little-endian machine).
inline std::uint64_t value_of_eight_digits(std::uint64_t bytes) {
    bytes &= 0x0f0f0f0f0f0f0f0fU;
    bytes = (bytes * 10 + (bytes >> 8)) & 0x00ff00ff00ff00ffU;    // pairs
    bytes = (bytes * 100 + (bytes >> 16)) & 0x0000ffff0000ffffU;  // fours
    return (bytes * 10'000 + (bytes >> 32)) & 0xffffffffU;
}

inline const char* scan_digits(const char* p, std::uint64_t& value) {
    for (;;) {
        std::uint64_t bytes;
        std::memcpy(&bytes, p, 8);
        if (!are_eight_digits(bytes)) break;
        value = value * 100'000'000U + value_of_eight_digits(bytes);
        p += 8;
    }
    for (unsigned d; (d = static_cast<unsigned>(*p) - unsigned{'0'}) < 10; ++p) value = value * 10 + d;
    return p;
}

[[nodiscard]] double double_from_text(const char* begin, const char* end);

}  // namespace detail

/// Scans a decimal number. The text must be followed by a byte that is not part of a number and by at least eight readable bytes.
/// Returns the end of the number, or nullptr if there is none.
inline const char* scan_decimal(const char* p, Decimal& d) {
    d.negative = *p == '-';
    if (*p == '-' || *p == '+') ++p;
    d.digits = 0;
    const char* start = p;
    p = detail::scan_digits(p, d.digits);
    d.count = static_cast<int>(p - start);
    d.exponent = 0;
    if (*p == '.') {
        const char* fraction = ++p;
        p = detail::scan_digits(p, d.digits);
        d.exponent = -static_cast<int>(p - fraction);
        d.count -= d.exponent;
    }
    if (d.count == 0) return nullptr;
    if ((*p | 0x20) == 'e') {
        const char* e = p + 1;
        const bool minus = *e == '-';
        if (*e == '-' || *e == '+') ++e;
        if (static_cast<unsigned>(*e) - unsigned{'0'} < 10) {
            int value = 0;
            for (unsigned k; (k = static_cast<unsigned>(*e) - unsigned{'0'}) < 10; ++e) {
                if (value < 100'000) value = value * 10 + static_cast<int>(k);
            }
            d.exponent += minus ? -value : value;
            p = e;
        }
    }
    return p;
}

/// The double nearest to the decimal scanned from [begin, end).
inline double value_of(const Decimal& d, const char* begin, const char* end) {
    // Both factors are exact doubles here, so the single operation rounds correctly.
    static constexpr double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                       1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (d.count <= 19 && d.digits <= (std::uint64_t{1} << 53) && d.exponent >= -22 && d.exponent <= 22) [[likely]] {
        const double m = static_cast<double>(d.digits);
        const double v = d.exponent < 0 ? m / power[-d.exponent] : m * power[d.exponent];
        return d.negative ? -v : v;
    }
    return detail::double_from_text(begin, end);
}

/// Nanoseconds of a decimal time in a unit, rounded to the nearest (halves away from zero), without conversion to double. [begin,
/// end) is the text scanned. False if the magnitude of the result exceeds 4e18 (126 years).
[[nodiscard]] bool nanoseconds_of(const Decimal& d, TimeUnit unit, const char* begin, const char* end, std::int64_t& ns);

/// A whole field as a double (blanks around it allowed): NaN if it is not a finite number (empty, "nan", text).
[[nodiscard]] double number_from(std::string_view field);
/// A whole field as a time; false if it is not one.
[[nodiscard]] bool nanoseconds_from(std::string_view field, TimeUnit unit, std::int64_t& ns);

/// True if a field looks like a number or a missing value (empty, nan, n/a, null, -).
[[nodiscard]] bool is_missing_value(std::string_view field);
[[nodiscard]] std::string_view trimmed(std::string_view field);

}  // namespace schuler::io
