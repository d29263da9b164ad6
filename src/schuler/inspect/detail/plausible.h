// Whether the numbers of a table agree with the names of its columns.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"

#include <string>
#include <utility>

namespace schuler::inspect::detail {

/// Why the numbers of a table that was found cannot be those of the instrument after which its columns are named, in any unit, and what
/// to do if they are; empty if they can. Its reader would refuse the rows, and with them the run of the other logs.
[[nodiscard]] std::pair<std::string, std::string> implausible(const LoadedFile& file);

}  // namespace schuler::inspect::detail
