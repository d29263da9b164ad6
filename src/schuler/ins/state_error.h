// Applying errors to navigation states: the only place that implements the sign convention of docs/conventions.md.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

namespace schuler::ins {

/// Position error (m), velocity error (m/s), attitude error phi (rad); local-level or Earth-fixed axes, as the state's frame.
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// The state with an estimated error dx = estimate minus truth removed: position -= dr (metres over R_M + h and R_N + h of the
/// estimate), velocity -= dv, C_nb := Exp([phi x]) C_nb. Poles excluded.
[[nodiscard]] NavState corrected(const earth::Earth& earth, const NavState& estimate, const Vector9& dx);
/// The estimate that has the error dx: corrected(perturbed(truth, dx), dx) == truth to rounding, for |dr| up to 100 km and
/// |lat| below 89 deg.
[[nodiscard]] NavState perturbed(const earth::Earth& earth, const NavState& truth, const Vector9& dx);

/// The same in the Earth-fixed frame, C_eb := Exp([phi x]) C_eb.
[[nodiscard]] NavStateEcef corrected(const NavStateEcef& estimate, const Vector9& dx);
[[nodiscard]] NavStateEcef perturbed(const NavStateEcef& truth, const Vector9& dx);

}  // namespace schuler::ins
