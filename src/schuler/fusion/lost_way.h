// A filter that lost its way: its heading or level was so wrong that neither it nor its rivals came back to the fixes. Only a start anew,
// in motion, helps.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <optional>

namespace schuler::fusion {

/// Where a run may have lost its way: the fixes had found the navigation wrong, it was opened, and within two minutes a tenth of the
/// positions (five at least) were refused none the less, or it was found wrong once more. A receiver that is wrong does not look like that:
/// it jumps or drifts, and the navigation is not found wrong by it. Returns the last position that was used before; the start of the run
/// where there is none.
[[nodiscard]] std::optional<Time> lost_way(const Result& result);

/// Positions that were refused after `since`, and those used.
struct PositionCount {
    std::size_t used = 0, refused = 0;
};
[[nodiscard]] PositionCount positions_after(const Result& result, Time since);

/// Whether a run that began anew at `since` explains what another refused: its attitude is another one (by five degrees for two
/// seconds of its first two minutes; where it is the same one, it is not the way that is wrong), and of the positions since then it refuses less than
/// half as many, and no more than a tenth.
[[nodiscard]] bool found_again(const Result& lost, const Result& anew, Time since);

/// The heading at the start of a run that its successor, begun anew where this one ends, shows: its own less what it is off by at the end,
/// for the gyros carry an error of the heading along. Nothing where the two agree within three sigma.
struct CarriedHeading {
    double heading = 0.0, std = 0.0;   ///< rad
};
[[nodiscard]] std::optional<CarriedHeading> heading_carried_back(const Result& before, const Result& after);

}  // namespace schuler::fusion
