// When did the body stand still? Decided from the IMU's own agitation, with thresholds learnt from the GNSS speed.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/fusion/settings.h"
#include "schuler/fusion/timeline.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::fusion {

/// One window of standing still: the mean raw rate over it (rad/s, body), for the zero-rate update.
struct StillWindow {
    Time end;
    double length;                 ///< s
    Eigen::Vector3d mean_rate_b;
    Eigen::Vector3d mean_force_b;  ///< m/s^2
};

/// How the thresholds came about.
struct StillThresholds {
    bool learnt = false;           ///< from GNSS speeds; otherwise from the noise of the IMU
    double force_std = 0.0;        ///< m/s^2, standard deviation in a window
    double rate_std = 0.0;         ///< rad/s
};

struct StillReport {
    std::vector<StillWindow> windows;   ///< non-overlapping, 0.2 s apart
    StillThresholds thresholds;
};

/// Finds the still windows. Only epochs of `events` that are not withheld teach the thresholds.
[[nodiscard]] StillReport find_still(const ImuTimeline& imu, const Recording& recording, const std::vector<Event>& events,
                                     const Settings& settings);

}  // namespace schuler::fusion
