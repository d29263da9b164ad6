// Intermediate coupling (paper A, 1.1): the tight filter, and in parallel a filter of the receiver alone. Each monitors the
// other, and each continues if the other's sensor is lost.
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Both filters, and their comparison at every epoch of ranges. The tight filter uses the measurements of the receiver's filter
/// and more: if both are correct, the variance of their difference is that of the receiver's error minus that of the tight
/// filter's; beyond five sigma they disagree. The solution is the tight filter's; it is the receiver's if the inertial log has a
/// gap of a second or more or has ended, and after ten epochs of disagreement until ten of agreement. With fewer than four ranges
/// the receiver's filter does not count as disagreeing. Attitude is always the inertial one, NaN after the log's end, where the
/// position is the antenna's. @throws Error(Input): there are no ranges.
[[nodiscard]] Result run_intermediate_pass(const RunData& data, const Settings& settings, const Start& start,
                                           const PassOptions& options);

}  // namespace schuler::fusion
