// In-motion realignment after a filter has diverged from the fixes: its heading or level was so wrong that neither it nor its
// rivals recovered.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <cstddef>
#include <optional>

namespace schuler::fusion {

/// True if a run with these settings may be realigned: it uses a receiver's fixes and may reject them by its gates.
[[nodiscard]] bool may_realign(const Settings& settings);

/// Whether a run has diverged: the fixes had shown the navigation to be wrong, its covariance was increased, and within two
/// minutes a tenth of the positions (at least five) were still rejected, or it was found wrong once more. A receiver fault
/// behaves differently: it jumps or drifts, and does not show the navigation to be wrong. Returns the time of the last position
/// used before; the start of the run if there is none.
[[nodiscard]] std::optional<Time> diverged_at(const Result& result);

/// Positions rejected after `since`, and those used.
struct PositionCount {
    std::size_t used = 0, refused = 0;
};
[[nodiscard]] PositionCount positions_after(const Result& result, Time since);

/// True if a run realigned at `since` explains the rejections of another: its attitude differs (by five degrees over two seconds
/// within its first two minutes; otherwise the attitude was not at fault), and of the positions since then it rejects less than
/// half as many, and at most a tenth.
[[nodiscard]] bool explains(const Result& anew, const Result& diverged, Time since);

/// The initial heading of a run and its sigma, rad, derived from its successor, which was realigned where this one ends.
struct CarriedHeading {
    double heading = 0.0, std = 0.0;
};
/// Its own heading less its error at the end, since the gyros preserve a heading error; with a sigma of one radian if the
/// successor starts more than five seconds later. Empty if the two agree within three sigma.
[[nodiscard]] std::optional<CarriedHeading> heading_carried_back(const Result& before, const Result& after);

}  // namespace schuler::fusion
