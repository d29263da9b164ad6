// Impossible single stamps, and restarting time counters, in the order of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace schuler::io {

struct TimeRepair {
    std::vector<std::size_t> strays;  ///< indices of rows stamped far from the surrounding ones, ascending
    std::size_t rollovers = 0;        ///< restarts of the seconds of the week or of the day
    std::int64_t period = 0;          ///< ns, of the last one
    [[nodiscard]] bool any() const { return !strays.empty() || rollovers > 0; }
};

/// Finds up to a few consecutive rows with stamps far ahead of or behind both neighbours (more than a second and twenty median
/// intervals), and continues times that fall from the end of a week (604800 s) or a day (86400 s) to its start.
/// @param times ns; changed only after a rollover
[[nodiscard]] TimeRepair repair_times(std::vector<std::int64_t>& times);

/// Spreads runs of equal stamps evenly up to the next stamp if the log is written so: most rows share a stamp, and the stamps
/// are steps of a clock coarser than the rows. The first run may have begun, and the last one ended, within a step.
/// @param times ns, ascending, of distinct rows
/// @return number of stamps changed
std::size_t spread_equal_times(std::vector<std::int64_t>& times);

}  // namespace schuler::io
