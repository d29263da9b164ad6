// Ranges as logged, as the single-point solution takes them.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/gnss/ranges.h"

#include <vector>

namespace schuler::gnss {

/// The satellites of an epoch, their clocks taken off the pseudoranges; stations are left out.
[[nodiscard]] std::vector<Range> satellite_ranges(const RangingLog& log, const RangeEpoch& epoch);

}  // namespace schuler::gnss
