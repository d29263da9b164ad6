// Fixes from carrier phases against a base station.
#pragma once

#include "schuler/app/config.h"
#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/ppk/solution.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::app {

/// Positions of a rover against the base, with what was found on the way.
struct CarrierPhase {
    std::vector<GnssFix> fixes;                  ///< GPS time
    std::vector<ppk::EpochSolution> epochs;      ///< of each fix
    Ecef base;
};

/// From the files of config.raw and config.base, whose relative paths start at `folder`.
/// @throws Error(Input): a file that cannot be read, a base that does not belong to the rover.
[[nodiscard]] CarrierPhase carrier_phase(const std::filesystem::path& folder, const Config& config, WarningLog& warnings);

/// carrier.csv: quality, satellites, integers and baseline of every epoch.
[[nodiscard]] std::string carrier_csv(const CarrierPhase& solution);

/// As RTKLIB numbers them: 1 fixed, 2 float, 5 single.
[[nodiscard]] int quality_number(ppk::Quality quality);

}  // namespace schuler::app
