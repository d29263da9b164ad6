// Calendar dates and times of day in text. Private to the readers.
#pragma once

#include "schuler/core/time.h"
#include "schuler/io/text/number.h"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace schuler::io::detail {

inline constexpr std::int64_t ns_per_second = 1'000'000'000;

/// An unsigned integer of at most nine digits.
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
    using namespace std::chrono;
    return year >= 1980 && year <= 2200 && month >= 1 && month <= 12 && day >= 1 && day <= 31 &&
           year_month_day(std::chrono::year{year}, std::chrono::month(static_cast<unsigned>(month)),
                          std::chrono::day(static_cast<unsigned>(day)))
               .ok();
}

/// A minute of a day and the remaining nanoseconds, separate because leap seconds belong to minutes.
struct MinuteAndRest {
    int hour = 0, minute = 0;
    std::int64_t rest_ns = 0;  ///< below 61 s
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

/// Days since 1970 of a date of ten characters or fewer: year first, or year last where one of the other two cannot be a month, or
/// `month_first` is known.
[[nodiscard]] inline std::optional<std::int64_t> days_of_date(std::string_view text, bool month_first) {
    const std::size_t first = text.find_first_of("-/."), second = text.find_first_of("-/.", first + 1);
    if (first == std::string_view::npos || second == std::string_view::npos || text[first] != text[second]) return std::nullopt;
    const auto a = small_integer(text.substr(0, first)), b = small_integer(text.substr(first + 1, second - first - 1)),
               c = small_integer(text.substr(second + 1));
    if (!a || !b || !c) return std::nullopt;
    int year = *c, month = *a, day = *b;
    constexpr int months = 12;
    if (first == 4) {
        year = *a;
        month = *b;
        day = *c;
    } else if (text.size() - second != 5 || (!month_first && *a <= months && *b <= months && *a != *b)) {
        return std::nullopt;  // the order does not show
    } else if (!month_first && *a > months) {
        std::swap(month, day);
    }
    if (!is_date(year, month, day)) return std::nullopt;
    using namespace std::chrono;
    return sys_days(std::chrono::year{year} / month / day).time_since_epoch().count();
}

/// The year, and the first two numbers, of a date with the year last (05/03/2024) of which both could be the month.
struct OpenDate {
    int first, second, year;
};
[[nodiscard]] inline std::optional<OpenDate> open_date(std::string_view text) {
    text = trimmed(text.substr(0, text.find_first_of(" T")));
    const std::size_t one = text.find_first_of("-/."), two = text.find_first_of("-/.", one + 1);
    if (one == std::string_view::npos || two == std::string_view::npos || one > 2 || text.size() - two != 5) return std::nullopt;
    const auto a = small_integer(text.substr(0, one)), b = small_integer(text.substr(one + 1, two - one - 1)),
               c = small_integer(text.substr(two + 1));
    if (!a || !b || !c || *a == *b || days_of_date(text, false) || !days_of_date(text, true)) return std::nullopt;
    return OpenDate{*a, *b, *c};
}

/// Hours of the day from those of a clock of twelve.
[[nodiscard]] inline int hour_of_twelve(int hour, bool afternoon) { return hour % 12 + (afternoon ? 12 : 0); }

/// A field such as "5/1/2024 1:59:00.5 PM" or "13/5/2024 14:00:00": the forms of spreadsheets, as calendar_nanoseconds.
[[nodiscard]] inline std::optional<std::int64_t> spreadsheet_nanoseconds(std::string_view text) {
    bool twelve = false, afternoon = false;
    if (text.size() > 3 && (text.back() == 'M' || text.back() == 'm')) {
        const char half = text[text.size() - 2];
        afternoon = half == 'P' || half == 'p';
        if (!afternoon && half != 'A' && half != 'a') return std::nullopt;
        twelve = true;
        text = trimmed(text.substr(0, text.size() - 2));
    }
    std::int64_t days = 0;
    const std::size_t blank = text.find_first_of(" T");
    if (blank != std::string_view::npos) {
        const auto date = days_of_date(text.substr(0, blank), twelve);
        if (!date) return std::nullopt;
        days = *date;
        text = trimmed(text.substr(blank + 1));
    } else if (!twelve) {
        return std::nullopt;
    }
    const std::size_t first = text.find(':'), second = text.find(':', first + 1);
    if (first == std::string_view::npos || second == std::string_view::npos) return std::nullopt;
    const auto t = time_of_day(text.substr(0, first), text.substr(first + 1, second - first - 1), text.substr(second + 1));
    if (!t || (twelve && (t->hour < 1 || t->hour > 12))) return std::nullopt;
    const int hour = twelve ? hour_of_twelve(t->hour, afternoon) : t->hour;
    return ((days * 24 + hour) * 60 + t->minute) * 60 * ns_per_second + t->rest_ns;
}

/// A field such as "2024-05-01T12:00:00.125Z", "2024/05/01 14:00:00+02:00" or "12:00:00.5": nanoseconds since 1970, UTC, counted
/// without leap seconds; since midnight if there is no date.
[[nodiscard]] inline std::optional<std::int64_t> standard_nanoseconds(std::string_view text) {
    std::int64_t days = 0;
    if (text.size() > 10 && (text[4] == '-' || text[4] == '/') && text[7] == text[4] && (text[10] == 'T' || text[10] == ' ')) {
        const auto y = small_integer(text.substr(0, 4)), m = small_integer(text.substr(5, 2)),
                   d = small_integer(text.substr(8, 2));
        if (!y || !m || !d || !is_date(*y, *m, *d)) return std::nullopt;
        using namespace std::chrono;
        days = sys_days(year{*y} / *m / *d).time_since_epoch().count();
        text.remove_prefix(11);
    }
    std::int64_t offset_minutes = 0;
    if (!text.empty() && text.back() == 'Z') {
        text.remove_suffix(1);
    } else if (const std::size_t sign = text.find_first_of("+-"); sign != std::string_view::npos) {
        const std::string_view zone = text.substr(sign + 1);
        const auto h = small_integer(zone.substr(0, 2));
        const auto m = zone.size() > 2 ? small_integer(zone.substr(zone[2] == ':' ? 3 : 2)) : std::optional<int>(0);
        if (!h || !m || *h > 14 || *m > 59) return std::nullopt;
        offset_minutes = (text[sign] == '-' ? -1 : 1) * (60 * *h + *m);
        text = text.substr(0, sign);
    }
    if (text.size() < 8 || text[2] != ':' || text[5] != ':') return std::nullopt;
    const auto t = time_of_day(text.substr(0, 2), text.substr(3, 2), text.substr(6));
    if (!t) return std::nullopt;
    return ((days * 24 + t->hour) * 60 + t->minute - offset_minutes) * 60 * ns_per_second + t->rest_ns;
}

/// The standard forms, and those of spreadsheets.
[[nodiscard]] inline std::optional<std::int64_t> calendar_nanoseconds(std::string_view text) {
    const auto ns = standard_nanoseconds(text);
    return ns ? ns : spreadsheet_nanoseconds(text);
}

}  // namespace schuler::io::detail
