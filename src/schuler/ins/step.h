// Strapdown mechanization as pure functions: geographic frame and Earth-fixed frame.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"
#include "schuler/ins/increments.h"

namespace schuler::ins {

/// One step in the geographic (north-east-down) frame; `state` at increment.time - increment.dt. Poles excluded. Second order in
/// dt (P. D. Groves, "Principles of GNSS, inertial, and multisensor integrated navigation systems", 2nd ed., ch. 5.4 and 5.5):
/// gravity, Coriolis, transport rate and radii at mid-step, the rotation of the local level during the step to second
/// order, position by the mean velocity. Longitude in (-pi, pi]. Allocates nothing.
[[nodiscard]] NavState step_n(const earth::Earth& earth, const NavState& state, const CompensatedIncrement& increment);

/// One step in the Earth-fixed frame; no positions are excluded. Same order and arguments.
[[nodiscard]] NavStateEcef step_e(const earth::Earth& earth, const NavStateEcef& state, const CompensatedIncrement& increment);

[[nodiscard]] NavStateEcef to_ecef(const earth::Earth& earth, const NavState& state);
[[nodiscard]] NavState to_geographic(const earth::Earth& earth, const NavStateEcef& state);

}  // namespace schuler::ins
