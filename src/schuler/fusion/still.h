// Detection of standstill from the variation of the IMU data, with thresholds learnt from the GNSS speed; with ranges alone,
// whose velocities are noisy, also from the means of these velocities.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/fusion/settings.h"
#include "schuler/fusion/timeline.h"

#include <vector>

namespace schuler::fusion {

/// Finds the standstill windows. Only epochs of `events` that are not withheld are used to learn the thresholds.
[[nodiscard]] StillReport find_still(const ImuTimeline& imu, const Recording& recording, const std::vector<Event>& events,
                                     const Settings& settings);

}  // namespace schuler::fusion
