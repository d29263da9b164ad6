// The filter backward in time over the same log (filter/update/reversed.h).
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Filters from the end of `forward` back to its start and returns the solution at its times, at most ten per second, before the
/// measurements at each time are used, so that no measurement is common to both filters there. In order of time.
///
/// It starts at the last estimate of the forward filter with ten times its sigmas, which thus has a relative weight of one
/// hundredth. The priors of the biases are those of `start`, all other states begin as in any run. Common to both filters remain
/// the settings, the estimated latencies and noise, and errors of fixes that are correlated between fixes.
/// @throws Error(Computation) if the filter diverges.
[[nodiscard]] std::vector<SolutionRow> run_backward(const RunData& data, const Settings& settings, const Start& start,
                                                    const Trajectory& forward);

}  // namespace schuler::fusion
