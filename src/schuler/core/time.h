// Time: integer nanoseconds on one continuous axis; seconds as double only for differences and at the interfaces.
#pragma once

#include <compare>
#include <cstdint>

namespace schuler {

/// A difference of two instants, nanoseconds.
struct Duration {
    std::int64_t ns = 0;

    [[nodiscard]] static Duration from_seconds(
        double s);  ///< nearest nanosecond; limited to +-4.6e9 s, so that two can be added; 0 if s is not a number
    [[nodiscard]] double seconds() const { return static_cast<double>(ns) * 1e-9; }
    auto operator<=>(const Duration&) const = default;
};

/// An instant on a data set's time axis (GPS time since 1980-01-06, or receiver-boot or relative time), nanoseconds.
struct Time {
    std::int64_t ns = 0;

    [[nodiscard]] static Time from_seconds(double s);
    /// GPS week and seconds of week; the seconds may exceed a week or be negative.
    [[nodiscard]] static Time from_gps(int week, double seconds_of_week);
    [[nodiscard]] double seconds() const { return static_cast<double>(ns) * 1e-9; }
    auto operator<=>(const Time&) const = default;
};

inline Duration operator-(Time a, Time b) { return {a.ns - b.ns}; }
inline Time operator+(Time a, Duration d) { return {a.ns + d.ns}; }
inline Time operator-(Time a, Duration d) { return {a.ns - d.ns}; }
inline Duration operator-(Duration d) { return {-d.ns}; }
inline Duration operator+(Duration a, Duration b) { return {a.ns + b.ns}; }

/// Index of the period that contains an instant. Time stamps scatter about a grid by less than 0.1 ms: a stamp just before its grid
/// point is counted with it.
[[nodiscard]] std::int64_t period_number(Time t, Duration period);

/// 1980-01-06 00:00:00 UTC in seconds since 1970-01-01 00:00:00 UTC.
inline constexpr std::int64_t unix_time_of_gps_epoch = 315'964'800;

enum class TimeScale { Gps, Utc, Boot, Relative };

/// Calendar instant, proleptic Gregorian.
struct Calendar {
    int year, month, day, hour, minute;
    double second;
};

/// GPS minus UTC, whole seconds, at a UTC instant given as seconds since 1980-01-06 00:00:00 UTC counted without leap
/// seconds. Zero before 1981-07-01. From a single table that ends with the leap second of 2016-12-31.
[[nodiscard]] int gps_minus_utc(std::int64_t utc_seconds_since_1980);

/// UTC calendar to GPS time. During a leap second (second >= 60) the result continues without a jump.
[[nodiscard]] Time gps_from_utc(const Calendar& utc);
/// GPS calendar (no leap seconds) to GPS time.
[[nodiscard]] Time gps_from_calendar(const Calendar& gps);
/// GPS time as seconds since 1970-01-01 00:00:00 UTC counted without leap seconds (Unix time), and back.
[[nodiscard]] Time unix_from_gps(Time gps);
[[nodiscard]] Time gps_from_unix(Time since_1970);
/// GPS time to UTC calendar; inside a leap second, second is in [60, 61).
[[nodiscard]] Calendar utc_from_gps(Time gps);

}  // namespace schuler
