// Names of the parts of one log: imu_0001.csv, imu_0002.csv; log.ubx, log.ubx.1; 2024-05-01-part2.csv.
#pragma once

#include <filesystem>
#include <string>

namespace schuler::io {

/// The file name without the numbers that tell the parts of a log apart, and without "part" before them: the same for all parts of one
/// log, which does not say that they are parts of one.
[[nodiscard]] std::string name_of_parts(const std::filesystem::path& path);

}  // namespace schuler::io
