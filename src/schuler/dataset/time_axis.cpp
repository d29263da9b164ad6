#include "schuler/dataset/time_axis.h"

#include <cmath>
#include <cstdio>
#include <type_traits>
#include <utility>

namespace schuler::dataset {

std::vector<GnssFix> shifted(std::vector<GnssFix> fixes, Duration by) {
    for (GnssFix& f : fixes) f.time = f.time + by;
    return fixes;
}

std::optional<OwnAxis> own_axis(const Recording& r) {
    if (!r.imu.empty()) return OwnAxis{r.imu.front().time.seconds(), r.imu.back().time.seconds()};
    if (!r.reference.empty()) return OwnAxis{r.reference.front().time.seconds(), r.reference.back().time.seconds()};
    return std::nullopt;
}

Duration axis_zero(const TimeConfig& time, Time first_fix, const OwnAxis& axis) {
    const double first = axis.first, last = axis.last;
    const std::int64_t utc = (first_fix.ns / 1'000'000'000) - gps_minus_utc(first_fix.ns / 1'000'000'000);
    const Duration leap = time.scale == TimeScale::Utc ? Duration{gps_minus_utc(utc) * std::int64_t{1'000'000'000}} : Duration{};
    constexpr double dated = 1e8, day = 86'400.0, week = 7 * day;
    if (time.scale == TimeScale::Utc && first > 1e9)
        return leap + Duration{-unix_time_of_gps_epoch * std::int64_t{1'000'000'000}};
    if (first > dated) return leap;
    if (time.week) return Time::from_gps(*time.week, 0.0) - Time{} + leap;
    if (!time.date.empty()) {
        Calendar c{0, 0, 0, 0, 0, 0.0};
        std::sscanf(time.date.c_str(), "%d-%d-%d", &c.year, &c.month, &c.day);
        return gps_from_calendar(c) - Time{} + leap;
    }
    // the difference is whole weeks, or whole days if the log cannot be seconds of a week
    const double unit = time.scale == TimeScale::Utc && last < day + 3600.0 ? day : week;
    return Duration::from_seconds(std::floor(first_fix.seconds() / unit) * unit) + leap;
}

std::vector<GnssFix> on_own_axis(std::vector<GnssFix> fixes, const TimeConfig& time, const Recording& recording,
                                 Duration offset) {
    const auto axis = own_axis(recording);
    if (fixes.empty() || !axis) return fixes;
    const Time first = fixes.front().time;
    return shifted(std::move(fixes), offset + -axis_zero(time, first, *axis));
}

void settle_rollover(Recording& r) {
    constexpr double week = 604'800.0;
    bool rolled = false;
    const auto each_log = [&r](auto visit) {
        visit(r.imu);
        visit(r.gnss);
        visit(r.reference);
        for_each_instrument_log(r, visit);
    };
    each_log([&](const auto& log) {
        rolled = rolled || (!log.empty() && log.front().time.seconds() < week && log.front().time.seconds() > 0.5 * week &&
                            log.back().time.seconds() >= week && log.back().time.seconds() < 1.5 * week);
    });
    if (!rolled) return;
    each_log([&](auto& log) {
        if (log.empty() || log.back().time.seconds() > 0.5 * week) return;
        for (auto& sample : log) sample.time = sample.time + Duration::from_seconds(week);
    });
}

void settle_drift(Recording& r, double drift) {
    if (drift == 0.0 || r.imu.empty()) return;
    const Time from = r.imu.front().time;
    const auto each = [&](auto& log) {
        for (auto& sample : log) sample.time = sample.time + Duration::from_seconds(-drift * (sample.time - from).seconds());
    };
    each(r.imu);
    for_each_instrument_log(r, [&]<class Sample>(std::vector<Sample>& log) {
        if constexpr (!std::is_same_v<Sample, HeadingSample>) each(log);  // two antennas: the receiver's clock
    });
}

}  // namespace schuler::dataset
