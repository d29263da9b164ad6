// Correction of steps in a log's clock.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/inspect/inspect.h"

#include <vector>

namespace schuler::dataset {

/// Removes the steps from the log whose clock caused them; if the inertial log is affected, also from the logs with a gap at the
/// same place, which share its clock. A step whose gap is not in the log, for example if its rows were read differently, is left.
void put_clock_steps_back(Recording& recording, const std::vector<inspect::ClockStep>& steps);

}  // namespace schuler::dataset
