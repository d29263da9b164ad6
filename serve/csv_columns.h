// Result tables stored as CSV by a run, as columns for drawing.
#pragma once

#include "serve/results.h"

#include <filesystem>
#include <span>
#include <string>

namespace schuler::serve {

/// A CSV file of a run whose first column is time_s (on the axis of the run if not `absolute`), and the group it is shown as. The table of a group is
/// GROUP/table.
struct CsvGroup {
    const char *file, *group;
    bool alone = false;     ///< only without run.h5, which would contain the same
    bool absolute = false;  ///< time_s is GPS time; the axis of the run begins at the origin of run.h5
};
[[nodiscard]] std::span<const CsvGroup> csv_groups();

/// All columns except the time, or the time alone; values that are not numbers are NaN. Units are at the end of the names.
/// @throws Error(Input)
[[nodiscard]] ColumnTable csv_columns(const std::filesystem::path& file, bool time);

}  // namespace schuler::serve
