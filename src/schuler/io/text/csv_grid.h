// Grids in text tables: lat_deg, lon_deg and the values of each point, points in any order.
#pragma once

#include "schuler/core/geodetic_grid.h"
#include "schuler/io/text/text_input.h"

#include <string>
#include <vector>

namespace schuler::io {

/// columns: one to three, by their names in the header; factor takes their numbers to SI. Values that are not asked for are zero.
/// @throws Error(Input) with the line: no number, no place on the Earth, a point that stands twice; with the point: one that is
/// missing; with the column: one that is missing.
[[nodiscard]] GeodeticGrid read_grid_csv(const TextInput& input, const std::vector<std::string>& columns, double factor);

}  // namespace schuler::io
