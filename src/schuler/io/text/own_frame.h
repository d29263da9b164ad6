// Trajectories with coordinates that are local to their file.
#pragma once

#include "schuler/io/text/table.h"

namespace schuler::io {

/// True if a table is a trajectory in its own coordinates x, y, z, without a position on the Earth.
[[nodiscard]] bool is_own_frame(const TableLayout& layout);

}  // namespace schuler::io
