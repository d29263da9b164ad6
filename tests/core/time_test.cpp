#include "schuler/core/time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace schuler {
namespace {

constexpr std::int64_t s = 1'000'000'000;

/// Julian day number at noon, in whole numbers (Fliegel and Van Flandern 1968): knows nothing of <chrono>.
std::int64_t julian_day(std::int64_t y, std::int64_t m, std::int64_t d) {
    const std::int64_t a = (m - 14) / 12;
    return 1461 * (y + 4800 + a) / 4 + 367 * (m - 2 - 12 * a) / 12 - 3 * ((y + 4900 + a) / 100) / 4 + d - 32075;
}

// The first of every month of two centuries, and the days beside it, against the other algorithm; and back.
TEST(Time, CalendarOfTwoCenturies) {
    const std::int64_t first = julian_day(1980, 1, 6);
    for (int year = 1972; year < 2170; ++year) {
        for (int month = 1; month <= 12; ++month) {
            const Time t = gps_from_calendar({year, month, 1, 0, 0, 0.0});
            ASSERT_EQ(t.ns, (julian_day(year, month, 1) - first) * 86'400 * s) << year << "-" << month;
            for (const std::int64_t off : {-1, 0, 1}) {
                const Time utc{t.ns + off * s};
                const Calendar c = utc_from_gps(utc);
                ASSERT_EQ(gps_from_utc(c).ns, utc.ns) << year << "-" << month;
            }
        }
    }
    EXPECT_EQ(gps_from_calendar({2024, 2, 29, 12, 30, 1.25}).ns - gps_from_calendar({2024, 2, 28, 12, 30, 1.0}).ns,
              86'400 * s + s / 4);
}

TEST(Time, WeeksAndTheirRollovers) {
    EXPECT_EQ(Time::from_gps(0, 0.0), gps_from_calendar({1980, 1, 6, 0, 0, 0.0}));
    EXPECT_EQ(Time::from_gps(1024, 0.0), gps_from_calendar({1999, 8, 22, 0, 0, 0.0}));
    EXPECT_EQ(Time::from_gps(2048, 0.0), gps_from_calendar({2019, 4, 7, 0, 0, 0.0}));
    EXPECT_EQ(Time::from_gps(2000, 604'800.5), Time::from_gps(2001, 0.5));
    EXPECT_EQ(Time::from_gps(2001, -0.25), Time::from_gps(2000, 604'799.75));
    // beyond what 64 bits hold it ends where it ends
    EXPECT_GT(Time::from_gps(1'101'100, 4e9), Time::from_gps(7'000, 0.0));
    EXPECT_LT(Time::from_gps(-2'000'000'000, -1e300), Time::from_gps(0, 0.0));
    // 2017-01-01 00:00:00 UTC as receivers print it
    EXPECT_EQ(gps_from_utc({2017, 1, 1, 0, 0, 0.0}).ns, 1'167'264'018 * s);
    EXPECT_EQ(gps_from_utc({1970, 1, 1, 0, 0, 0.0}).ns, -unix_time_of_gps_epoch * s);
}

// Every leap second since 1980 (IERS Bulletin C): 23:59:60 lies between 23:59:59 and 00:00:00, two seconds apart.
// clang-format off
TEST(Time, LeapSeconds) {
    const int dates[][2] = {{1981, 7}, {1982, 7}, {1983, 7}, {1985, 7}, {1988, 1}, {1990, 1}, {1991, 1}, {1992, 7}, {1993, 7},
                            {1994, 7}, {1996, 1}, {1997, 7}, {1999, 1}, {2006, 1}, {2009, 1}, {2012, 7}, {2015, 7}, {2017, 1}};
    // clang-format on
    int offset = 0;
    for (const auto& [year, month] : dates) {
        const Time after = gps_from_utc({year, month, 1, 0, 0, 0.0});
        const Time inside{after.ns - s / 2}, before{after.ns - 2 * s};
        const Calendar c = utc_from_gps(inside);
        EXPECT_EQ(c.minute, 59);
        EXPECT_EQ(c.second, 60.5) << year;
        EXPECT_EQ(gps_from_utc(c), inside) << year;
        EXPECT_EQ(utc_from_gps(before).second, 59.0) << year;
        EXPECT_EQ(utc_from_gps(after).second, 0.0) << year;
        ++offset;
        const std::int64_t utc = after.ns / s - offset;
        EXPECT_EQ(gps_minus_utc(utc), offset);
        EXPECT_EQ(gps_minus_utc(utc - 1), offset - 1);
    }
    EXPECT_EQ(offset, 18);
}

TEST(Time, PeriodsOfAGridOfStampsThatScatter) {
    const Duration period = Duration::from_seconds(0.1);
    const auto number = [&](double t) { return period_number(Time::from_seconds(t), period); };
    EXPECT_EQ(number(0.3), 3);
    EXPECT_EQ(number(0.29995), 3);  // just before its grid point
    EXPECT_EQ(number(0.2998), 2);
    EXPECT_EQ(number(0.3999), 4);
    EXPECT_EQ(number(-0.0002), -1);
    EXPECT_EQ(number(-0.00005), 0);
    EXPECT_EQ(number(-0.1), -1);
    EXPECT_EQ(number(-0.15), -2);
}

TEST(Time, SecondsToTheNanosecond) {
    EXPECT_EQ(Duration::from_seconds(0.1).ns, 100'000'000);
    EXPECT_EQ(Duration::from_seconds(-0.1).ns, -100'000'000);
    EXPECT_EQ(Duration::from_seconds(1e-9).ns, 1);
    EXPECT_EQ(Time::from_seconds(1'400'000'000.5).ns, 1'400'000'000'500'000'000);
    EXPECT_EQ((Time{5} - Time{8}).ns, -3);
    EXPECT_EQ(Time{5} + Duration{3}, Time{8});
    EXPECT_LT(Time{5}, Time{8});
}

}  // namespace
}  // namespace schuler
