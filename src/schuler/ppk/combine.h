// One solution of a pass forwards and a pass backwards in time.
#pragma once

#include "schuler/ppk/solution.h"

namespace schuler::ppk {

/// Of two solutions of one epoch the better one. They have the epoch's measurements in common, so neither makes the other more certain; where
/// they contradict each other beyond their sigmas, one has wrong integers or an unseen slip: then nothing is fixed, and the covariance
/// covers the difference.
[[nodiscard]] EpochSolution combined(const EpochSolution& forward, const EpochSolution& backward);

}  // namespace schuler::ppk
