// The files of a folder with raw satellite measurements, and selection of the receiver to be located.
#pragma once

#include "schuler/core/fact.h"
#include "schuler/dataset/description.h"
#include "schuler/inspect/given.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::dataset {

struct RawObservations {
    std::vector<Fact> facts;   ///< gnss.observations, gnss.navigation, and filter.scheme if alone; empty if there are none
    std::string dataset_toml;  ///< the same as text, with the other files in comments
    RawGnssConfig files;       ///< the same as what is read
};

/// For a folder, or one file with the navigation files beside it; empty if there are no ephemerides. RINEX takes precedence over
/// receiver logs (UBX, RTCM 3), which may need no navigation files; of several RINEX files a rover over a base station: by their
/// headers, by their names, else the first by name. `alone`: no IMU is present, only single-epoch positions are possible.
[[nodiscard]] RawObservations raw_observations(const std::filesystem::path& path, bool alone = true);

/// Single-epoch fixes for the analysis of an IMU log recorded with raw measurements; empty on failure, which the loader reports.
[[nodiscard]] inspect::ComputedFixes computed_fixes(const std::filesystem::path& folder, const RawGnssConfig& raw);

}  // namespace schuler::dataset
