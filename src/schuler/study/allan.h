// `schuler analyze allan`: the noise of the inertial sensors of a log or a scenario.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"

namespace schuler::study {

/// Allan deviations, coefficients and spectra of the six body axes, over the interval defined by start and stop. For a scenario:
/// of its simulated IMU. Only an instrument at rest shows its noise alone.
/// @throws Error(Input) if the log is too short
[[nodiscard]] report::Outcome analyze_allan(const settings::ProcessRequest& request);

}  // namespace schuler::study
