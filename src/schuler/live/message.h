// Messages of a live run: the state, events and health as lines.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/filter/navigator.h"
#include "schuler/live/decoder.h"

#include <string>
#include <string_view>

namespace schuler::live {

[[nodiscard]] std::string_view name_of(filter::Phase phase);
[[nodiscard]] std::string_view name_of(filter::Source source);
[[nodiscard]] std::string_view name_of(filter::FeedStatus status);

[[nodiscard]] SolutionRow row_of(const filter::NavigatorState& state);

[[nodiscard]] std::string state_json(const SolutionRow& row, bool lagged);
/// GGA, RMC and HDT. Without a date on the axis of time (before the year 2000) the date is empty.
[[nodiscard]] std::string state_nmea(const SolutionRow& row);
[[nodiscard]] std::string event_json(const filter::NavigatorEvent& event);
[[nodiscard]] std::string event_text(const filter::NavigatorEvent& event);

/// What a health message says.
struct Health {
    double time = not_given;  ///< s, of the newest sample of the IMU
    filter::Phase phase = filter::Phase::WaitingForImu;
    double imu_rate = 0.0;  ///< Hz, measured
    const filter::FeedCounters* fed = nullptr;
    std::size_t garbage = 0, foreign = 0, reconnections = 0, dropped = 0, readers = 0;
    double latency_median = not_given, latency_largest = not_given;  ///< s, from the arrival of a sample to its message
};
[[nodiscard]] std::string health_json(const Health& health);

}  // namespace schuler::live
