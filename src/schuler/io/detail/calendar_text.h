// Calendar dates and times of day in text. Private to the readers.
#pragma once

#include "schuler/core/time.h"
#include "schuler/io/number.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

namespace schuler::io::detail {

inline constexpr std::int64_t ns_per_second = 1'000'000'000;

/// An unsigned whole number of at most nine digits.
[[nodiscard]] inline std::optional<int> small_integer(std::string_view text) {
    if (text.empty() || text.size() > 9) return std::nullopt;
    int value = 0;
    for (const char c : text) {
        if (c < '0' || c > '9') return std::nullopt;
        value = value * 10 + (c - '0');
    }
    return value;
}

[[nodiscard]] inline bool is_date(int year, int month, int day) {
    static constexpr std::array<int, 12> days = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    if (year < 1980 || year > 2200 || month < 1 || month > 12 || day < 1) return false;
    const bool leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    return day <= days[static_cast<std::size_t>(month - 1)] + (leap && month == 2 ? 1 : 0);
}

/// A minute of a day and the nanoseconds after it, kept apart because leap seconds belong to minutes.
struct MinuteAndRest {
    int hour = 0, minute = 0;
    std::int64_t rest_ns = 0;   ///< below 61 s
};

[[nodiscard]] inline std::optional<MinuteAndRest> time_of_day(std::string_view hour, std::string_view minute,
                                                              std::string_view second) {
    const auto h = small_integer(hour), m = small_integer(minute);
    MinuteAndRest t;
    if (!h || !m || *h > 23 || *m > 59 || !nanoseconds_from(second, TimeUnit::Seconds, t.rest_ns)) return std::nullopt;
    if (t.rest_ns < 0 || t.rest_ns >= 61 * ns_per_second) return std::nullopt;
    t.hour = *h;
    t.minute = *m;
    return t;
}

}  // namespace schuler::io::detail
