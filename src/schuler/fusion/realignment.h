// Realignment, in motion, where a filter has diverged from the fixes: its heading or level was so wrong that neither it nor its rivals
// came back to them.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <cstddef>
#include <optional>

namespace schuler::fusion {

/// Whether a run with these settings may be realigned: one that takes a receiver's fixes and may refuse them by its gates.
[[nodiscard]] bool may_realign(const Settings& settings);

/// Where a run may have diverged: the fixes had found the navigation wrong, it was opened, and within two minutes a tenth of the positions
/// (five at least) were refused none the less, or it was found wrong once more. A receiver that is wrong does not look like that: it jumps
/// or drifts, and the navigation is not found wrong by it. Returns the time of the last position that was used before; the start of the run
/// where there is none.
[[nodiscard]] std::optional<Time> diverged_at(const Result& result);

/// Positions that were refused after `since`, and those used.
struct PositionCount {
    std::size_t used = 0, refused = 0;
};
[[nodiscard]] PositionCount positions_after(const Result& result, Time since);

/// Whether a run that was realigned at `since` explains what another refused: its attitude is another one (by five degrees for two
/// seconds of its first two minutes; where it is the same one, it is not the attitude that was wrong), and of the positions since then it
/// refuses less than half as many, and no more than a tenth.
[[nodiscard]] bool explains(const Result& anew, const Result& diverged, Time since);

/// The heading at the start of a run, and its sigma, rad, as its successor, realigned where this one ends, shows them.
struct CarriedHeading {
    double heading = 0.0, std = 0.0;
};
/// Its own less what it is off by at the end, for the gyros carry an error of the heading along; with a radian of uncertainty where the
/// successor begins more than five seconds later. Nothing where the two agree within three sigma.
[[nodiscard]] std::optional<CarriedHeading> heading_carried_back(const Result& before, const Result& after);

}  // namespace schuler::fusion
