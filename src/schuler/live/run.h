// A live run: samples in, messages out, until it is told to stop.
#pragma once

#include "schuler/live/settings.h"

#include <cstddef>
#include <functional>
#include <string>

namespace schuler::live {

/// What a run has done.
struct LiveReport {
    std::size_t imu = 0, fixes = 0, garbage = 0, dropped = 0, reconnections = 0;
    double seconds = 0.0;
    filter::Phase phase = filter::Phase::WaitingForImu;
    bool restored = false, saved = false;
    double latency_median = not_given,
           latency_999 = not_given;  ///< s, from the arrival of a sample of the IMU to its state's message
};

/// Runs until SIGINT or SIGTERM, until all sources have ended, or until `stop` (may be empty; asked ten times a second) says so.
/// @throws Error(Input) for settings of which there is no navigator
[[nodiscard]] LiveReport run_live(const LiveSettings& settings, const std::function<bool()>& stop);

}  // namespace schuler::live
