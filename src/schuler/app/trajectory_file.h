// A trajectory from any file that can be read as one.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/nav_state.h"

#include <filesystem>
#include <vector>

namespace schuler::app {

/// solution.csv, a reference, a folder with solution.csv, an RTKLIB .pos file, an NMEA log, or ten columns without names (time,
/// latitude, longitude, height, velocity NED, roll, pitch, heading). Absent components are NaN; at least one row.
/// @throws Error(Input) with file, line, column and mend.
[[nodiscard]] std::vector<SolutionRow> read_trajectory(const std::filesystem::path& file, WarningLog& warnings);

}  // namespace schuler::app
