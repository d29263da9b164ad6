// Trajectories whose coordinates mean nothing outside their file.
#pragma once

#include "schuler/io/text/table.h"

namespace schuler::io {

/// Whether a table is a trajectory in coordinates x, y, z of its own, without a place on the Earth.
[[nodiscard]] bool is_own_frame(const TableLayout& layout);

}  // namespace schuler::io
