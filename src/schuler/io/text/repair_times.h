// Single stamps that cannot be, and counters of time that begin anew, in the order of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace schuler::io {

struct TimeRepair {
    std::vector<std::size_t> strays;  ///< indices of rows whose stamp lies far from those around it, ascending
    std::size_t rollovers = 0;        ///< times that seconds of the week, or of the day, began anew
    std::int64_t period = 0;          ///< ns, of the last one
    [[nodiscard]] bool any() const { return !strays.empty() || rollovers > 0; }
};

/// Finds up to a few rows in a row whose stamps are far ahead of or behind both neighbours (more than a second and twenty median
/// steps), and carries times on where they fall from the end of a week (604800 s) or a day (86400 s) to its beginning.
/// @param times ns; stays as it is but for what follows a rollover
[[nodiscard]] TimeRepair repair_times(std::vector<std::int64_t>& times);

}  // namespace schuler::io
