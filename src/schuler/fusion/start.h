// Automatic start-up: position, velocity, level, heading.
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Whether position, velocity and attitude are given with their sigmas: nothing of the start has to be found.
[[nodiscard]] bool gives_start(const InitialSettings& initial);

/// Determines the initial state from the data if it is not given by the settings. Throws Error(Input) if it cannot start (no fix
/// within the IMU's time) and warns if the heading could not be determined.
[[nodiscard]] Start find_start(const RunData& data, const Settings& settings, Findings& findings, WarningLog& warnings);

/// The same start for latencies of its fixes that are larger by `position` and `velocity` (s).
[[nodiscard]] Start with_later_fixes(const Start& start, const earth::Earth& earth, double position, double velocity);

}  // namespace schuler::fusion
