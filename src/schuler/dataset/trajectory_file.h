// Reading a trajectory from any suitable file.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/nav_state.h"
#include "schuler/core/samples.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/csv/csv_recording.h"

#include <filesystem>
#include <vector>

namespace schuler::dataset {

/// Truth or another program's solution: CSV with header, solution.csv, or a table of ten columns without them (time, latitude,
/// longitude, height, velocity NED, roll, pitch, heading in degrees). @throws Error(Input).
[[nodiscard]] std::vector<ReferenceSample> read_reference(const io::TextInput& file, io::CsvOptions options,
                                                          WarningLog& warnings);

/// A table of this many numbers per row, without column names, for which the options do not define every column.
[[nodiscard]] bool is_bare_table(const io::TextInput& input, const io::CsvOptions& options, int columns);

/// Rows with the clock that the format of their file states; Boot if it states none.
struct Trajectory {
    std::vector<SolutionRow> rows;
    io::Clock clock = io::Clock::Boot;
};

/// solution.csv, a reference, a folder with solution.csv, a trajectory of any readable format (a stream of it: FILE#STREAM), or
/// ten columns without names (time, latitude, longitude, height, velocity NED, roll, pitch, heading). Absent components are NaN;
/// at least one row. @throws Error(Input) with file, line, column and hint.
[[nodiscard]] Trajectory read_trajectory(const std::filesystem::path& file, WarningLog& warnings);

}  // namespace schuler::dataset
