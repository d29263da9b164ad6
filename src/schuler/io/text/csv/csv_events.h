// Instants at which the solution is requested, and the solution there.
#pragma once

#include "schuler/core/instrument_logs.h"
#include "schuler/core/nav_state.h"
#include "schuler/io/text/text_input.h"

#include <filesystem>
#include <span>
#include <vector>

namespace schuler::io {

/// time_s [, name], in any order; other columns are ignored. Returned in file order. @throws Error(Input) with the line: a time
/// that is not a number; with the column: no time_s; without any event.
[[nodiscard]] std::vector<NamedInstant> read_events_csv(const TextInput& input);

/// One row per event with the columns of solution.csv and `name`. @throws as SolutionCsvWriter
void write_events_csv(const std::filesystem::path& file, std::span<const NamedInstant> events, std::span<const SolutionRow> rows);

}  // namespace schuler::io
