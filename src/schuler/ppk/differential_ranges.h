// Ranges and carrier phases of a rover less those of a base station, for a filter with its own model of motion.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/ppk/base_station.h"
#include "schuler/ppk/settings.h"
#include "schuler/ppk/solution.h"

#include <vector>

namespace schuler::ppk {

/// Every satellite in common: its first code and all its phases less the base's residuals and less the air's delay, the rover's Doppler.
/// The rover's clock stays in all of them; the base's, continued by its phases, does not. The phases of an arc begin as its code, by
/// a whole number of cycles. `solutions`: of the same epochs; their positions serve for air and elevation. Times are tags; epochs
/// without a base or with fewer than four satellites in common are omitted.
[[nodiscard]] RangingLog differential_ranges(const std::vector<TrackedEpoch>& rover, const BaseStation& station,
                                             const SignalPlan& plan, const std::vector<EpochSolution>& solutions,
                                             const Settings& settings);

}  // namespace schuler::ppk
