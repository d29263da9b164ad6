// Steps of a clock within a log, by the motion before and after them.
#pragma once

#include "schuler/inspect/detail/motion.h"
#include "schuler/inspect/inspect.h"

#include <vector>

namespace schuler::inspect::detail {

/// Looks whether a hole of one log is a step of its clock: the samples after it fit the other log where they are stamped earlier by all that is
/// longer than a usual step, with the lag that they have before it, and as they are stamped they do not. A hole without enough motion on both
/// sides, and one that both logs share, stays a hole.
/// @param imu, gnss on one axis of seconds; the steps that are found are taken out of them, in order of time
/// @param gravity m/s^2, local
[[nodiscard]] std::vector<ClockStep> take_out_clock_steps(ImuSeries& imu, GnssSeries& gnss, double gravity);

}  // namespace schuler::inspect::detail
