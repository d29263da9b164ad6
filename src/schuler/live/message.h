// Messages of a live run: state, events and health as lines of text.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/filter/navigator.h"
#include "schuler/live/decoder.h"

#include <string>
#include <string_view>
#include <vector>

namespace schuler::live {

[[nodiscard]] std::string_view name_of(filter::Phase phase);
[[nodiscard]] std::string_view name_of(filter::Source source);
[[nodiscard]] std::string_view name_of(filter::FeedStatus status);

[[nodiscard]] SolutionRow row_of(const filter::NavigatorState& state);

[[nodiscard]] std::string state_json(const SolutionRow& row, bool lagged);
/// GGA, RMC and HDT. If the time axis has no date (before the year 2000) the date is empty.
[[nodiscard]] std::string state_nmea(const SolutionRow& row);
[[nodiscard]] std::string event_json(const filter::NavigatorEvent& event);
/// `time`: s, of the newest sample of the IMU.
[[nodiscard]] std::string satellites_json(double time, const std::vector<SatelliteSeen>& satellites);
[[nodiscard]] std::string event_text(const filter::NavigatorEvent& event);

/// Content of a health message.
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
