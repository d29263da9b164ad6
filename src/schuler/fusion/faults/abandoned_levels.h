// Positions of the receiver that the filter took after an interruption and then gave up for others.
#pragma once

#include "schuler/filter/result.h"
#include "schuler/filter/update/timeline.h"

#include <cstddef>
#include <vector>

namespace schuler::fusion {

/// After an interruption the first fixes determine the position, right or wrong: some receivers are metres off for seconds when they
/// find their signals again. When they jump without the inertial unit sensing it, and the later positions last longer, the filter moves
/// there (filter/integrity/refused_fixes.h). That is causal; a smoother must not use the first ones.
struct AbandonedLevel {
    Time first, last;  ///< stamps of the first and the last fix that was used there
    double size = 0;   ///< m, of the jump
};

/// Levels of a forward pass that began with the log or after an interruption, which the position predicted for the first fix does
/// not prefer to those that followed, and that were given up once until the next interruption. Where a level was given up
/// more often, none is reported.
[[nodiscard]] std::vector<AbandonedLevel> abandoned_levels(const filter::Result& forward);

/// Withholds their positions. Returns how many.
std::size_t withhold(std::vector<filter::Event>& events, const std::vector<AbandonedLevel>& levels);

}  // namespace schuler::fusion
