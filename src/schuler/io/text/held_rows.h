// Fixes that a logger holds and writes again with every row of a faster instrument.
#pragma once

#include <cstddef>
#include <vector>

namespace schuler::io {

/// Indices, ascending, of the rows that repeat the row before because it is held; none if the repetitions do not look like that: the
/// values change at a steady interval of several rows, except for pauses, in which a receiver at rest or without a fix repeats its last fix.
/// Coordinates that are rounded coarsely repeat at intervals that depend on the speed, and are kept.
/// @param repeats for each row: all its values are those of the row before
[[nodiscard]] std::vector<std::size_t> held_rows(const std::vector<bool>& repeats);

}  // namespace schuler::io
