// A live run: samples in, messages out, until stopped.
#pragma once

#include "schuler/live/settings.h"

#include <cstddef>
#include <functional>
#include <string>

namespace schuler::live {

/// Statistics of a run.
struct LiveReport {
    std::size_t imu = 0, fixes = 0, garbage = 0, dropped = 0, reconnections = 0;
    double seconds = 0.0;
    filter::Phase phase = filter::Phase::WaitingForImu;
    bool restored = false, saved = false;
    double latency_median = not_given,
           latency_999 = not_given;  ///< s, from the arrival of an IMU sample to the message of its state
};

/// Runs until SIGINT or SIGTERM, until all sources have ended, or until `stop` (may be empty; called ten times a second) returns
/// true. @throws Error(Input) if no navigator can be created from the settings
[[nodiscard]] LiveReport run_live(const LiveSettings& settings, const std::function<bool()>& stop);

}  // namespace schuler::live
