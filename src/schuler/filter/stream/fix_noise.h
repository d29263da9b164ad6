// Standard deviations used for a fix.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/update/timeline.h"

namespace schuler::filter {

/// True if a stated sigma (m or m/s) is one that a receiver can have.
[[nodiscard]] bool is_stated(double sigma);

/// White part of the total sigma stated in a log, if the slow part is a state (both in one unit).
[[nodiscard]] double white_part(double stated, double slow);

/// Noise of one fix: the log's sigma (scaled, raised to the floor), or the default if the log has none.
[[nodiscard]] FixNoise noise_of(const GnssFix& fix, const GnssSettings& settings);

}  // namespace schuler::filter
