// The filter backward in time over the same log: a second solution that uses the fixes still ahead of the forward one.
//
// With tau = -t a body obeys the same equations: position, attitude and specific force are unchanged, velocity and angular rate
// change sign, and so does the Earth rate (centrifugal and Coriolis terms are even in both together). The increments are
// processed in reverse order with reversed angles; gyro biases, clock drift and latency change sign as states, accelerometer
// biases, scale factors, misalignments and lever arms do not. Stationary and random-walk processes are unchanged. The same filter
// therefore runs over the reversed data (the backward filter of [Fraser1969]).
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
