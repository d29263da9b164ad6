// `schuler analyze observability SCENARIO`.
#pragma once

#include "schuler/study/theory/observability.h"

namespace schuler::study {

/// Information of the measurements along the path about each state and about combinations of states, and during which manoeuvre.
/// @throws Error(Input) for an option of gravimetry, with it as key
[[nodiscard]] report::Outcome analyze_path_observability(const ObservabilityRequest& request);

}  // namespace schuler::study
