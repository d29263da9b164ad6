// Standard deviations that a fix is used with.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/update/timeline.h"

namespace schuler::filter {

/// Whether a stated sigma can be meant: finite and positive.
[[nodiscard]] bool is_stated(double sigma);

/// White part of the sigma that a log states of the whole error, whose slow part is a state (both in one unit).
[[nodiscard]] double white_part(double stated, double slow);

/// Noise of one fix: the log's sigma (scaled, raised to the floor), or the default where the log has none.
[[nodiscard]] FixNoise noise_of(const GnssFix& fix, const GnssSettings& settings);

}  // namespace schuler::filter
