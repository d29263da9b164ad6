// Noise of carrier phases as a log shows it.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/gnss/single_point.h"

namespace schuler::gnss {

/// One sigma at the zenith, m, of the change of a satellite's phase between two epochs (RangeSample::phase_span), from what the
/// changes of an epoch leave beside the receiver's displacement and clock: the median over up to 300 epochs of the log, so that
/// slips in some of them do not count. NaN with fewer than ten epochs of six such phases.
[[nodiscard]] double phase_change_sigma(const RangingLog& log, const SinglePointSettings& settings);

}  // namespace schuler::gnss
