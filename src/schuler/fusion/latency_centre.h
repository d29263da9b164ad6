// Latencies about which the filter is linear: rows with a latency as a state extrapolate the motion over its error, which holds over some
// hundredths of a second. Where a trial run finds the state farther from zero, the latency is corrected before the actual run.
#pragma once

#include "schuler/fusion/gnss_faults.h"
#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Corrects latencies that are states and were not given (GnssSettings::latency_found) by their estimates at the end of a trial over
/// at most ten minutes, twice if the first correction is large; `data` follows. Their sigmas become three times those of the trial
/// if that is smaller. Reported in `findings.tuned`. True if something was corrected: the start is then to be found again.
[[nodiscard]] bool centre_latencies(RunData& data, Settings& settings, Start start, const FixScreen& screen, Findings& findings);

}  // namespace schuler::fusion
