// Which files of a folder hold raw satellite measurements, and which of several receivers is the one to be located.
#pragma once

#include "schuler/core/fact.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::dataset {

struct RawObservations {
    std::vector<Fact> facts;   ///< gnss.observations, gnss.navigation, filter.scheme where alone; empty where there are none
    std::string dataset_toml;  ///< the same as text, with the other files in comments
};

/// Of a folder, or of one file with the navigation files beside it; nothing where nothing has ephemerides. RINEX comes before logs of
/// receivers (UBX, RTCM 3), which may need no navigation files; of several RINEX files a rover comes before a base station: by their
/// headers, by their names, else the first by name. `alone`: no IMU is beside them, positions of single epochs are all that can be had.
[[nodiscard]] RawObservations raw_observations(const std::filesystem::path& path, bool alone = true);

}  // namespace schuler::dataset
