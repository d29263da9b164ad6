// Parts of one log: imu_0001.csv, imu_0002.csv; log.ubx, log.ubx.1; 2024-05-01-part2.csv. By their names and their times.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace schuler::io {

/// The file name without the numbers that distinguish the parts of a log, and without "part" before them: the same for all parts of one
/// log, which does not say that they are parts of one.
[[nodiscard]] std::string name_of_parts(const std::filesystem::path& path);

/// First and last sample of a file, s.
struct FileSpan {
    double start, stop;
};

/// True if b begins at the end of a or later, or up to a fifth of the shorter before it: parts may share some rows.
[[nodiscard]] bool follows(const FileSpan& a, const FileSpan& b);

/// The files, in order of time, that with the `chosen` one form a log without a pause of more than ten minutes, which would be one
/// between recordings. Two instruments that measure at the same time are no parts of one log.
[[nodiscard]] std::vector<std::size_t> chain_of_parts(std::span<const FileSpan> files, std::size_t chosen);

}  // namespace schuler::io
