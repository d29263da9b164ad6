// The filter backward in time over the same log: a second solution, which knows the fixes that the forward one has yet to see.
//
// With tau = -t a body obeys the same equations: position, attitude and specific force are what they were, velocity and angular rate change
// their signs, and so does the rate of the Earth (centrifugal and Coriolis terms are even in both together). The increments come in the
// opposite order, their angles with the opposite sign; gyro biases, clock drift and latency change sign as states, accelerometer biases,
// scale factors, misalignments and lever arms do not. Stationary and random-walk processes are what they were. So the same filter runs over
// turned data (the backward filter of [Fraser1969]).
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Filters from the end of `forward` back to the start of its walk and gives the solution at its times, at most ten a second, before the
/// measurements of each time are used: what both filters use is then no measurement. In order of time.
///
/// It starts at the last estimate of the forward filter with ten times its sigmas: the weight of that in it is a hundredth. The biases'
/// priors are those of `start`, all other states begin as in any run. Shared with the forward filter remain settings, what was found of
/// latencies and noise, and errors of fixes that last longer than from one fix to the next.
/// @throws Error(Computation) where the filter diverges.
[[nodiscard]] std::vector<SolutionRow> run_backward(const RunData& data, const Settings& settings, const Start& start,
                                                    const Trajectory& forward);

}  // namespace schuler::fusion
