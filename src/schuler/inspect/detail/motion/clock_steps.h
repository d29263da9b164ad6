// Clock steps within a log, detected from the motion before and after them.
#pragma once

#include "schuler/inspect/detail/motion/motion.h"
#include "schuler/inspect/inspect.h"

#include <vector>

namespace schuler::inspect::detail {

/// Tests whether a gap in one log is a step of its clock: with the following samples stamped earlier by the excess over a usual
/// interval, they agree with the other log at the same lag as before, but not as stamped. A gap without sufficient motion on both
/// sides, or common to both logs, remains a gap.
/// @param imu, gnss on one axis of seconds; the detected steps are removed from them, in time order
/// @param gravity m/s^2, local
[[nodiscard]] std::vector<ClockStep> take_out_clock_steps(ImuSeries& imu, GnssSeries& gnss, double gravity);

}  // namespace schuler::inspect::detail
