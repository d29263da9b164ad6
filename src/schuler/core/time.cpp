#include "schuler/core/time.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace schuler {
namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;
constexpr std::int64_t s_per_day = 86'400;
constexpr std::int64_t s_per_week = 7 * s_per_day;

constexpr std::chrono::sys_days gps_epoch = std::chrono::year{1980} / 1 / 6;

/// Days from the GPS epoch to a date of the proleptic Gregorian calendar.
constexpr std::int64_t days_since_gps_epoch(int y, int m, int d) {
    using namespace std::chrono;
    return (sys_days{year{y} / m / 1} - gps_epoch).count() + d - 1;
}

/// First UTC second (counted without leap seconds) at which GPS - UTC has the value index + 1.
constexpr std::array<std::int64_t, 18> leap_starts = {
    days_since_gps_epoch(1981, 7, 1) * s_per_day, days_since_gps_epoch(1982, 7, 1) * s_per_day,
    days_since_gps_epoch(1983, 7, 1) * s_per_day, days_since_gps_epoch(1985, 7, 1) * s_per_day,
    days_since_gps_epoch(1988, 1, 1) * s_per_day, days_since_gps_epoch(1990, 1, 1) * s_per_day,
    days_since_gps_epoch(1991, 1, 1) * s_per_day, days_since_gps_epoch(1992, 7, 1) * s_per_day,
    days_since_gps_epoch(1993, 7, 1) * s_per_day, days_since_gps_epoch(1994, 7, 1) * s_per_day,
    days_since_gps_epoch(1996, 1, 1) * s_per_day, days_since_gps_epoch(1997, 7, 1) * s_per_day,
    days_since_gps_epoch(1999, 1, 1) * s_per_day, days_since_gps_epoch(2006, 1, 1) * s_per_day,
    days_since_gps_epoch(2009, 1, 1) * s_per_day, days_since_gps_epoch(2012, 7, 1) * s_per_day,
    days_since_gps_epoch(2015, 7, 1) * s_per_day, days_since_gps_epoch(2017, 1, 1) * s_per_day};

std::int64_t whole_minutes_in_seconds(const Calendar& c) {
    return days_since_gps_epoch(c.year, c.month, c.day) * s_per_day + c.hour * 3600 + c.minute * 60;
}

/// Sums of two of these do not overflow. Not a number: 0.
std::int64_t to_ns(double s) {
    constexpr double most = 4.6e9;
    if (!(std::abs(s) < most)) return std::isnan(s) ? 0 : static_cast<std::int64_t>(s < 0.0 ? -most : most) * ns_per_s;
    const double whole = std::floor(s);
    return static_cast<std::int64_t>(whole) * ns_per_s + std::llround((s - whole) * 1e9);
}

Calendar calendar_from_seconds(std::int64_t s, std::int64_t ns) {
    std::int64_t days = s / s_per_day;
    std::int64_t rest = s % s_per_day;
    if (rest < 0) {
        rest += s_per_day;
        --days;
    }
    const std::chrono::year_month_day date = gps_epoch + std::chrono::days(days);
    return {static_cast<int>(date.year()),
            static_cast<int>(static_cast<unsigned>(date.month())),
            static_cast<int>(static_cast<unsigned>(date.day())),
            static_cast<int>(rest / 3600),
            static_cast<int>(rest % 3600 / 60),
            static_cast<double>(rest % 60) + static_cast<double>(ns) * 1e-9};
}

}  // namespace

Duration Duration::from_seconds(double s) { return {to_ns(s)}; }
Time Time::from_seconds(double s) { return {to_ns(s)}; }

std::int64_t period_number(Time t, Duration period) {
    constexpr std::int64_t scatter_ns = 100'000;
    const std::int64_t ns = t.ns + scatter_ns;
    return ns >= 0 ? ns / period.ns : -((-ns + period.ns - 1) / period.ns);
}

Time Time::from_gps(int week, double seconds_of_week) {
    constexpr std::int64_t last = INT64_MAX / ns_per_s,
                           most_weeks = (last - 4'600'000'001) / s_per_week;  // upper limit of the addition in to_ns
    return {std::clamp<std::int64_t>(week, -most_weeks, most_weeks) * s_per_week * ns_per_s + to_ns(seconds_of_week)};
}

int gps_minus_utc(std::int64_t utc_seconds_since_1980) {
    int count = 0;
    for (const std::int64_t start : leap_starts) count += utc_seconds_since_1980 >= start ? 1 : 0;
    return count;
}

Time gps_from_unix(Time since_1970) {
    const std::int64_t utc = since_1970.ns - unix_time_of_gps_epoch * ns_per_s;
    return {utc + gps_minus_utc(utc / ns_per_s) * ns_per_s};
}

Time unix_from_gps(Time gps) {
    const std::int64_t seconds = gps.ns / ns_per_s;
    const int leap = gps_minus_utc(seconds - gps_minus_utc(seconds));
    return {gps.ns + (unix_time_of_gps_epoch - leap) * ns_per_s};
}

Time gps_from_utc(const Calendar& utc) {
    // The minute determines the offset, so that second 60 of a leap second still has the offset of its minute.
    const std::int64_t minutes = whole_minutes_in_seconds(utc);
    return {(minutes + gps_minus_utc(minutes)) * ns_per_s + to_ns(utc.second)};
}

Time gps_from_calendar(const Calendar& gps) { return {whole_minutes_in_seconds(gps) * ns_per_s + to_ns(gps.second)}; }

Calendar utc_from_gps(Time gps) {
    std::int64_t s = gps.ns / ns_per_s;
    std::int64_t ns = gps.ns % ns_per_s;
    if (ns < 0) {
        ns += ns_per_s;
        --s;
    }
    for (std::size_t i = leap_starts.size(); i-- > 0;) {
        const auto offset = static_cast<std::int64_t>(i) + 1;
        const std::int64_t leap_second = leap_starts[i] + offset - 1;  // GPS second of the inserted 23:59:60
        if (s == leap_second) {
            Calendar c = calendar_from_seconds(leap_starts[i] - 1, ns);
            c.second += 1.0;
            return c;
        }
        if (s > leap_second) return calendar_from_seconds(s - offset, ns);
    }
    return calendar_from_seconds(s, ns);
}

}  // namespace schuler
