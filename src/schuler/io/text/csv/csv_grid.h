// Grids in text tables: lat_deg, lon_deg and the values of each point, points in any order.
#pragma once

#include "schuler/core/geodetic_grid.h"
#include "schuler/io/text/text_input.h"

#include <string>
#include <vector>

namespace schuler::io {

/// columns: one to three, by their names in the header; factor converts their numbers to SI. Values not requested are zero.
/// @throws Error(Input) with the line: not a number, not a position on the Earth, a duplicate point; with the point: a missing
/// one; with the column: a missing one.
[[nodiscard]] GeodeticGrid read_grid_csv(const TextInput& input, const std::vector<std::string>& columns, double factor);

}  // namespace schuler::io
