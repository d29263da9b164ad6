// Heights of a receiver beside those of a barometer: which of two that part is wrong, the inertial unit tells.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/filter/update/timeline.h"
#include "schuler/fusion/gnss_faults.h"
#include "schuler/fusion/settings.h"

#include <vector>

namespace schuler::fusion {

/// Fixes, one a fix, whose height leaves the barometer's by more than 10 m, six sigma of what the two usually differ by and a twentieth of the
/// height itself, beside what they differ by in the ten minutes around. Which of the two moved is told by the vertical
/// acceleration of each, over four seconds, against the size of the specific force less gravity: the receiver's is wrong where the
/// barometer's agrees clearly better. A barometer that is wrong, and what neither tells, is left to the filter; so is everything where a
/// third of the fixes would be left out.
[[nodiscard]] std::vector<bool> heights_off_barometer(const Recording& recording, const filter::ImuTimeline& imu,
                                                      const earth::Earth& earth);

/// Adds them to what is left out, with a warning: heights, and the vertical velocities with them. Nothing where the barometer is not
/// used, without gates, and with integrity control.
void screen_heights(FixScreen& screen, const Recording& recording, const filter::ImuTimeline& imu, const Settings& settings,
                    Time origin, WarningLog& warnings);

}  // namespace schuler::fusion
