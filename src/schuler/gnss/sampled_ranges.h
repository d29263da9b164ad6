// Logged ranges in the form used by the single-point solution.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/gnss/ranges.h"

#include <vector>

namespace schuler::gnss {

/// The satellites of an epoch, with their clocks removed from the pseudoranges; stations are omitted.
[[nodiscard]] std::vector<Range> satellite_ranges(const RangingLog& log, const RangeEpoch& epoch);

}  // namespace schuler::gnss
