// Start-up without hand-tuning: position, velocity, level, heading.
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Finds the initial state from the data where the settings do not give it. Throws Error(Input) where there is nothing to start
/// from (no fix inside the IMU's time) and warns where the heading could not be found.
[[nodiscard]] Start find_start(const RunData& data, const Settings& settings, Findings& findings, WarningLog& warnings);

/// The same start had the latencies of the fixes that it was made of been larger by `position` and `velocity` (s).
[[nodiscard]] Start with_later_fixes(const Start& start, const earth::Earth& earth, double position, double velocity);

}  // namespace schuler::fusion
