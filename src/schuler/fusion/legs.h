// Legs of a log: what lies between pauses that no inertial navigation can carry on over.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <vector>

namespace schuler::fusion {

/// s without inertial samples after which navigation restarts: a hole this long bridged by interpolation says nothing of where the vehicle went.
inline constexpr double longest_bridge = 120.0;

/// The first inertial sample of each leg; one where there is no pause, none of an empty log. A shorter hole begins a leg too where both logs have it
/// and the vehicle came only as far as it does in a usual step: no time has passed, the clock of both was set.
[[nodiscard]] std::vector<Time> leg_starts(const Recording& recording);

/// The samples of one leg: inertial ones from `from` to before `to`, the others from half way through the pauses around it.
[[nodiscard]] Recording leg_of(const Recording& recording, const std::vector<Time>& starts, std::size_t leg);

/// The samples from `from` to before `to`.
[[nodiscard]] Recording part_of(const Recording& recording, Time from, Time to);

/// Settings for a leg after another: what that one found is in force, the biases begin where they were, with the sigmas of a switch-on.
/// A car that is where it was parked points where it pointed, and whatever a clock was set under keeps its attitude. `seconds`: from the origin of the whole log to that of the leg.
[[nodiscard]] Settings continued(const Settings& settings, const Result& before, const Recording& leg, double seconds);

/// Puts the results of a leg behind those of the legs before it.
void append(Result& all, Result&& leg);

}  // namespace schuler::fusion
