// Fixed columns of RINEX text. Private to its readers.
#pragma once

#include "schuler/core/time.h"
#include "schuler/io/bytes.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/number.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

namespace schuler::io::detail {

inline constexpr std::size_t label_column = 60;
[[nodiscard]] inline bool has_label(std::string_view line, std::string_view label) {
    return line.size() >= label_column + label.size() && line.substr(label_column, label.size()) == label;
}

/// A right-aligned integer; empty if blank or damaged.
[[nodiscard]] inline std::optional<int> integer_in(std::string_view text) {
    text = trimmed(text);
    const bool minus = !text.empty() && text.front() == '-';
    if (minus) text.remove_prefix(1);
    const auto value = small_integer(text);
    if (!value) return std::nullopt;
    return minus ? -*value : *value;
}

/// A number with D, d, E or e before its exponent, at most 24 characters. NaN if there is none.
[[nodiscard]] inline double real_in(std::string_view text) {
    text = trimmed(text);
    char copy[32];
    if (text.empty() || text.size() > 24) return NAN;
    std::size_t n = 0;
    for (const char c : text) copy[n++] = c == 'D' || c == 'd' ? 'e' : c;
    return number_from({copy, n});
}

/// Calendar to GPS time; empty for a date or time that does not exist. Seconds as decimal text.
[[nodiscard]] inline std::optional<Time> calendar_time(std::optional<int> year, std::optional<int> month, std::optional<int> day,
                                                       std::string_view hour, std::string_view minute, std::string_view second,
                                                       TimeScale scale) {
    if (!year || !month || !day || !is_date(*year, *month, *day)) return std::nullopt;
    const auto h = integer_in(hour), m = integer_in(minute);
    std::int64_t ns = 0;
    if (!h || !m || *h < 0 || *h > 24 || *m < 0 || *m > 60) return std::nullopt;
    if (!nanoseconds_from(trimmed(second), TimeUnit::Seconds, ns) || ns < 0 || ns > 61 * ns_per_second) return std::nullopt;
    const Calendar c{*year, *month, *day, *h, *m, 0.0};
    return Time{(scale == TimeScale::Utc ? gps_from_utc(c) : gps_from_calendar(c)).ns + ns};
}

/// Two-digit years of RINEX 2: 80 to 99 belong to the last century.
[[nodiscard]] inline std::optional<int> full_year(std::optional<int> year) {
    if (year && *year < 100) *year += *year < 80 ? 2000 : 1900;
    return year;
}

}  // namespace schuler::io::detail
