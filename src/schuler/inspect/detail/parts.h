// Logs in parts: consecutive files of one instrument, joined in order of time.
#pragma once

#include "schuler/inspect/detail/study.h"

namespace schuler::inspect::detail {

/// Written by a run of this program and unchanged: not a log, and not a reference for the next run.
[[nodiscard]] bool is_result(const LoadedFile& file);

/// Joins the parts of the log that was chosen to it: logs of its folder with its name except for numbers, and its columns, that continue
/// it without a long pause. Other logs named like parts, and logs that continue it and are not joined, are reported.
/// The log of the earliest part, which has the rows of all, is returned.
LoadedFile* with_parts(Study& study, LoadedFile* chosen, const std::string& section);

/// The rows of given parts behind those of the log.
void join_given(LoadedFile& file, std::vector<LoadedFile> parts);

}  // namespace schuler::inspect::detail
