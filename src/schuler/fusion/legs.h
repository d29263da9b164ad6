// Legs of a log: the parts between pauses too long for inertial navigation to continue.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <vector>

namespace schuler::fusion {

/// s without inertial samples after which navigation restarts: interpolation over a longer gap contains no information about the motion.
inline constexpr double longest_bridge = 120.0;

/// The first inertial sample of each leg; one if there is no pause, none for an empty log. A shorter gap also starts a leg if
/// both logs have it and the vehicle moved no further than in a usual step: no time has passed; the clock of both was set.
[[nodiscard]] std::vector<Time> leg_starts(const Recording& recording);

/// The samples of one leg: inertial ones in [`from`, `to`), the others up to the middle of the adjacent pauses.
[[nodiscard]] Recording leg_of(const Recording& recording, const std::vector<Time>& starts, std::size_t leg);

/// The samples in [`from`, `to`).
[[nodiscard]] Recording part_of(const Recording& recording, Time from, Time to);

/// Settings for a leg that follows another: estimated settings are adopted, the biases start at their last values with the sigmas of a switch-on. A car still
/// at its parking position keeps its heading, and after a mere clock step the attitude is kept. `seconds`: from the origin of the whole log to that of the leg.
[[nodiscard]] Settings continued(const Settings& settings, const Result& before, const Recording& leg, double seconds);

/// Appends the results of a leg to those of the preceding legs.
void append(Result& all, Result&& leg);

}  // namespace schuler::fusion
