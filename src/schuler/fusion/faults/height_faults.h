// Heights of the receiver compared with those of a barometer; the inertial unit shows which of the two is wrong.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/filter/update/timeline.h"
#include "schuler/fusion/faults/gnss_faults.h"
#include "schuler/fusion/settings.h"

#include <vector>

namespace schuler::fusion {

/// Flags, one per fix, of heights that differ from the barometer's by more than 10 m, six sigma of their usual difference and a
/// twentieth of the height itself, relative to their difference in the surrounding ten minutes. The vertical acceleration of
/// each, over four seconds, is compared with the magnitude of the specific force minus gravity: the receiver is wrong if the
/// barometer agrees clearly better. A faulty barometer and undecided cases are left to the filter, and so is everything if a
/// third of the fixes would be excluded.
[[nodiscard]] std::vector<bool> heights_off_barometer(const Recording& recording, const filter::ImuTimeline& imu,
                                                      const earth::Earth& earth);

/// Adds them to the excluded parts, with a warning: heights and their vertical velocities. No effect if the barometer is not
/// used, without gates, or with integrity control.
void screen_heights(FixScreen& screen, const Recording& recording, const filter::ImuTimeline& imu, const Settings& settings,
                    Time origin, WarningLog& warnings);

}  // namespace schuler::fusion
