// Intermediate coupling (paper A, 1.1): the tight filter, and beside it a filter of the receiver alone. Each checks the other,
// and each lives on when the other's sensor is lost.
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Both filters, and the check of one against the other at every epoch of ranges. The tight filter uses what the receiver's uses
/// and more: while both are right, their difference has the variance of the receiver's error less that of the tight filter's;
/// beyond five times that they disagree. The solution is the tight filter's, but the receiver's where the inertial log has a hole
/// of a second or more or has ended, and where the two have disagreed for ten epochs, until they have agreed for ten. With fewer than four ranges the receiver does not contradict. Attitude
/// stays the inertial one, NaN after the log's end, where the position is the antenna's. @throws Error(Input): there are no
/// ranges.
[[nodiscard]] Result run_intermediate_pass(const RunData& data, const Settings& settings, const Start& start,
                                           const PassOptions& options);

}  // namespace schuler::fusion
