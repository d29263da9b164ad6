// Steps of a log's clock, put back.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/inspect/inspect.h"

#include <vector>

namespace schuler::dataset {

/// Takes the steps out of the log whose clock made them; with the inertial log go those that have a hole at the same place, which share its
/// clock. A step whose hole is not in the log, as where its rows were read otherwise, is left.
void put_clock_steps_back(Recording& recording, const std::vector<inspect::ClockStep>& steps);

}  // namespace schuler::dataset
