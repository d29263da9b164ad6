// Latencies about which the filter is linear: rows with a latency as a state extrapolate the motion over its error, which holds over some
// hundredths of a second. Where a trial run finds the state farther from zero, the latency is corrected before the actual run.
#pragma once

#include "schuler/fusion/faults/gnss_faults.h"
#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Corrects latencies that are states and were not given (GnssSettings::latency_found) by their estimates at the end of a trial over
/// at most ten minutes, once more if they are still far after the first; `data` follows. Their sigmas remain: the run uses the same
/// fixes again, and the verdict doubts what fixes alone cannot determine. Reported in `findings.tuned`. True if something was corrected:
/// the start is then to be found again.
[[nodiscard]] bool centre_latencies(RunData& data, Settings& settings, Start start, const FixScreen& screen, Findings& findings);

}  // namespace schuler::fusion
