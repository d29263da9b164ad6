#include "schuler/io/text/number.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace schuler::io {
namespace {

constexpr std::array<std::uint64_t, 20> powers_of_ten = [] {
    std::array<std::uint64_t, 20> p{};
    p[0] = 1;
    for (std::size_t i = 1; i < p.size(); ++i) p[i] = p[i - 1] * 10;
    return p;
}();

int shift_of(TimeUnit unit) {
    switch (unit) {
        case TimeUnit::Seconds: return 9;
        case TimeUnit::Milliseconds: return 6;
        case TimeUnit::Microseconds: return 3;
        case TimeUnit::Nanoseconds: return 0;
    }
    return 9;
}

/// Scans again, keeping only the first 19 significant digits: further digits are below a nanosecond for any valid time.
void keep_leading_digits(const char* p, const char* end, Decimal& d) {
    const int written_exponent = d.exponent;
    int kept = 0, after = 0;
    d.digits = 0;
    for (; p < end && (*p | 0x20) != 'e'; ++p) {
        if (*p < '0' || *p > '9') continue;
        if (kept < 19) {
            d.digits = d.digits * 10 + static_cast<std::uint64_t>(*p - '0');
            if (d.digits > 0) ++kept;
        } else {
            ++after;
        }
    }
    d.exponent = written_exponent + after;
}

/// Copy with a stop byte and readable bytes after it, as required by the scanners.
struct Padded {
    std::string text;
    explicit Padded(std::string_view field) : text(trimmed(field)) { text.append(16, '\0'); }
    [[nodiscard]] const char* begin() const { return text.data(); }
    [[nodiscard]] const char* end() const { return text.data() + text.size() - 16; }
};

}  // namespace

double detail::double_from_text(const char* begin, const char* end) {
    if (begin < end && *begin == '+') ++begin;
    double value = std::numeric_limits<double>::quiet_NaN();
    const auto result = fast_float::from_chars(begin, end, value);
    // Beyond the range of doubles the result is infinite: not a measurement.
    if (result.ptr != end || !std::isfinite(value)) return std::numeric_limits<double>::quiet_NaN();
    return value;
}

bool nanoseconds_of(const Decimal& decimal, TimeUnit unit, const char* begin, const char* end, std::int64_t& ns) {
    Decimal d = decimal;
    if (d.count > 19) keep_leading_digits(begin, end, d);
    constexpr std::uint64_t largest = 4'000'000'000'000'000'000U;  // 126 years; differences of two still fit
    const int shift = d.exponent + shift_of(unit);
    std::uint64_t magnitude = 0;
    if (d.digits == 0 || shift < -19) {
        magnitude = 0;
    } else if (shift < 0) {
        const std::uint64_t divisor = powers_of_ten[static_cast<std::size_t>(-shift)];
        const std::uint64_t rest = d.digits % divisor;
        magnitude = d.digits / divisor + (rest >= divisor - rest ? 1 : 0);
    } else {
        if (shift > 18 || d.digits > largest / powers_of_ten[static_cast<std::size_t>(shift)]) return false;
        magnitude = d.digits * powers_of_ten[static_cast<std::size_t>(shift)];
    }
    if (magnitude > largest) return false;
    ns = d.negative ? -static_cast<std::int64_t>(magnitude) : static_cast<std::int64_t>(magnitude);
    return true;
}

std::string_view trimmed(std::string_view field) {
    constexpr std::string_view blanks = " \t\r\n\v\f";
    const std::size_t first = field.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return field.substr(first, field.find_last_not_of(blanks) - first + 1);
}

double number_from(std::string_view field) {
    const Padded padded(field);
    Decimal d;
    const char* end = scan_decimal(padded.begin(), d);
    if (end == nullptr || end != padded.end()) return std::numeric_limits<double>::quiet_NaN();
    const double value = value_of(d, padded.begin(), end);
    return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
}

bool nanoseconds_from(std::string_view field, TimeUnit unit, std::int64_t& ns) {
    const Padded padded(field);
    Decimal d;
    const char* end = scan_decimal(padded.begin(), d);
    return end != nullptr && end == padded.end() && nanoseconds_of(d, unit, padded.begin(), end, ns);
}

bool is_missing_value(std::string_view field) {
    std::string lower(trimmed(field));
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const std::string_view word :
         {"", "nan", "-nan", "+nan", "na", "n/a", "null", "none", "-", "inf", "-inf", "+inf", "#n/a"}) {
        if (lower == word) return true;
    }
    return false;
}

}  // namespace schuler::io
