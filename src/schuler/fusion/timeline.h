// From a recording to the input of the filter: body increments without gaps, and measurements in order of validity.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/filter/update/timeline.h"
#include "schuler/fusion/faults/gnss_faults.h"
#include "schuler/fusion/settings.h"

#include <vector>

namespace schuler::fusion {

/// Forms increments (over (time - dt, time], body axes) from an IMU log: units, stamps, axes, mounting; duplicates dropped; gaps
/// bridged by interpolation and marked. Throws Error(Input) for fewer than two usable rows.
[[nodiscard]] ImuTimeline make_imu_timeline(const std::vector<ImuSample>& samples, const ImuSettings& settings,
                                            WarningLog& warnings);

/// Epochs of all instruments in order of validity, duplicates dropped, latencies applied, outages marked. origin: zero of the
/// outage times (stamp of the first GNSS epoch). screen: excluded parts of the fixes.
[[nodiscard]] std::vector<Event> make_events(const Recording& recording, const Settings& settings, Time origin,
                                             WarningLog& warnings, const FixScreen& screen = {});

}  // namespace schuler::fusion
