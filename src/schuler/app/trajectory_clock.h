// The time scale of a trajectory that is converted or compared.
#pragma once

#include "schuler/dataset/trajectory_file.h"

#include <filesystem>

namespace schuler::app {

/// True if the times count from 1970 UTC: by the format of the file, by the settings of the run that it belongs to, or by its columns
/// and values as `inspect` reads them.
[[nodiscard]] bool counts_from_1970(const dataset::Trajectory& trajectory, const std::filesystem::path& file);

/// From 1970 UTC to GPS time.
void to_gps_time(dataset::Trajectory& trajectory);

}  // namespace schuler::app
