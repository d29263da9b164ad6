// Weeks of the satellite systems relative to GPS time.
#pragma once

#include "schuler/core/time.h"
#include "schuler/gnss/satellite.h"

namespace schuler::gnss {

inline constexpr std::int64_t week_ns = 604'800'000'000'000;

/// Lag of a system's week behind GPS time: BeiDou's started without the leap seconds of 1980 to 2006.
[[nodiscard]] constexpr Duration lag_of(System system) {
    return {system == System::BeiDou ? std::int64_t{14'000'000'000} : std::int64_t{0}};
}

/// GPS week of a system's week zero.
[[nodiscard]] constexpr int first_week_of(System system) {
    return system == System::BeiDou ? 1356 : system == System::Galileo ? 1024 : 0;
}

/// GPS week and second of week on a system's own scale.
struct WeekSecond {
    int week = 0;
    double second = 0;
};
[[nodiscard]] inline WeekSecond week_second(Time t, System system = System::Gps) {
    const std::int64_t ns = (t - lag_of(system)).ns, in_week = (ns % week_ns + week_ns) % week_ns;
    return {static_cast<int>((ns - in_week) / week_ns), static_cast<double>(in_week) * 1e-9};
}

}  // namespace schuler::gnss
