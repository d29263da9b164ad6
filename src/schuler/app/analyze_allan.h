// `schuler analyze allan`: the noise of the inertial sensors of a log or a scenario.
#pragma once

#include "schuler/app/commands.h"

namespace schuler::app {

/// Allan deviations, coefficients and spectra of the six body axes, over the stretch that the settings' start and stop leave.
/// Of a scenario: of the IMU it simulates. Only an instrument at rest shows its noise alone.
/// @throws Error(Input) where the log is too short
[[nodiscard]] Outcome analyze_allan(const ProcessRequest& request);

}  // namespace schuler::app
