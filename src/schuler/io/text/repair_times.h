// Impossible single stamps, clocks that are off for a while, and restarting time counters, in the order of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace schuler::io {

struct TimeRepair {
    std::vector<std::size_t> strays;  ///< indices of rows stamped far from the surrounding ones, ascending
    std::size_t rollovers = 0;        ///< restarts of the seconds of the week or of the day
    std::int64_t period = 0;          ///< ns, of the last one
    std::size_t excursions = 0;       ///< times that the clock stepped away and back
    std::size_t away = 0;             ///< rows in them
    std::size_t first_away = 0;       ///< index of the first such row
    std::int64_t step = 0;            ///< ns, of the last one
    [[nodiscard]] bool any() const { return !strays.empty() || rollovers > 0 || excursions > 0; }
};

/// Finds up to a few consecutive rows with stamps far ahead of or behind both neighbours (more than a second and twenty median
/// intervals), and continues times that fall from the end of a week (604800 s) or a day (86400 s) to its start. Rows between a step
/// of the clock and a step of the same size (to half a usual interval) the other way, of which one goes back, were written in order by
/// a clock that was off: with that step taken back they lie evenly between the others, and sorted they would lie among rows that were
/// measured at other times. Single rows cannot be distinguished from rows written late: more than five are needed, and less than half of the log.
/// @param times ns; changed only after a rollover and in such an interval
[[nodiscard]] TimeRepair repair_times(std::vector<std::int64_t>& times);

/// Spreads runs of equal stamps evenly up to the next stamp if the log is written so: most rows share a stamp, and the stamps
/// are steps of a clock coarser than the rows. The first run may have begun, and the last one ended, within a step.
/// @param times ns, ascending, of distinct rows
/// @return number of stamps changed
std::size_t spread_equal_times(std::vector<std::int64_t>& times);

}  // namespace schuler::io
