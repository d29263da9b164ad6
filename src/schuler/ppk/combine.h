// Combination of a forward and a backward pass.
#pragma once

#include "schuler/ppk/solution.h"

namespace schuler::ppk {

/// Selects the better of two solutions of one epoch. They share the epoch's measurements, so combination does not reduce the
/// variance; if they differ beyond their sigmas, one has wrong integers or an undetected slip: the result is then not fixed, and
/// its covariance covers the difference.
[[nodiscard]] EpochSolution combined(const EpochSolution& forward, const EpochSolution& backward);

}  // namespace schuler::ppk
