// Velocities that a receiver does not measure: columns of zeros beside positions that travel.
#pragma once

#include "schuler/core/samples.h"

#include <vector>

namespace schuler::io {

/// True if all given velocities are zero although more than a tenth of the positions are over 50 m away from their median.
[[nodiscard]] bool has_idle_velocities(const std::vector<GnssFix>& fixes);

}  // namespace schuler::io
