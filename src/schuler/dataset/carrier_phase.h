// Fixes from carrier phases relative to a base station.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"
#include "schuler/ppk/solution.h"

#include <filesystem>
#include <vector>

namespace schuler::dataset {

/// Positions of a rover relative to the base, with additional findings.
struct CarrierPhase {
    std::vector<GnssFix> fixes;              ///< GPS time
    std::vector<ppk::EpochSolution> epochs;  ///< of each fix
    Ecef base;
    RangingLog ranges;        ///< relative to the base, by the rover's clock; only if asked for
    double base_sigma = 0.0;  ///< m, of the base's position
};

/// From the raw and base files of the description, with relative paths based on `folder`; with `ranges` too if asked for.
/// @throws Error(Input): a file that cannot be read, a base that does not belong to the rover.
[[nodiscard]] CarrierPhase carrier_phase(const std::filesystem::path& folder, const Description& description, bool ranges,
                                         WarningLog& warnings);

}  // namespace schuler::dataset
