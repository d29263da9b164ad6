// Fixes from carrier phases against a base station.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"
#include "schuler/ppk/solution.h"

#include <filesystem>
#include <vector>

namespace schuler::dataset {

/// Positions of a rover against the base, with what was found on the way.
struct CarrierPhase {
    std::vector<GnssFix> fixes;              ///< GPS time
    std::vector<ppk::EpochSolution> epochs;  ///< of each fix
    Ecef base;
};

/// From the files of the description's raw and base, whose relative paths start at `folder`.
/// @throws Error(Input): a file that cannot be read, a base that does not belong to the rover.
[[nodiscard]] CarrierPhase carrier_phase(const std::filesystem::path& folder, const Description& description,
                                         WarningLog& warnings);

}  // namespace schuler::dataset
