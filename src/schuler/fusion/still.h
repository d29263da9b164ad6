// When did the body stand still? Decided from the IMU's own agitation, with thresholds learnt from the GNSS speed; with ranges alone, whose
// velocities are noisy, from the means of those too.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/fusion/settings.h"
#include "schuler/fusion/timeline.h"

#include <vector>

namespace schuler::fusion {

/// Finds the still windows. Only epochs of `events` that are not withheld teach the thresholds.
[[nodiscard]] StillReport find_still(const ImuTimeline& imu, const Recording& recording, const std::vector<Event>& events,
                                     const Settings& settings);

}  // namespace schuler::fusion
