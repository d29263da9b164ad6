// Shared by both mechanizations: resolution of an increment in a frame that rotates during the step.
#pragma once

#include "schuler/ins/increments.h"
#include "schuler/math/triple.h"

#include <cmath>

namespace schuler::ins::detail {

/// Velocity increment in a frame r that rotates by zeta (rad, small) during the step, in the rotating axes of r: the
/// integral of Exp(-[zeta x] t/T) C_rb(0) C_b(0)b(t) f, to second order in the rotations. q_rb: attitude at the start.
/// With u = C_rb dv it is u - 1/2 zeta x (u + 1/6 (theta - 2 zeta) x u): exact to that order for constant rates, in particular
/// for a body at rest on the turning Earth.
[[nodiscard]] inline math::Triple velocity_increment_in(const Eigen::Quaterniond& q_rb, const CompensatedIncrement& increment,
                                                        const math::Triple& zeta) {
    const Eigen::Matrix3d C = q_rb.toRotationMatrix();  // cheaper than two rotations by the quaternion
    const math::Triple u = math::product(C, math::Triple(increment.dv)), theta = math::product(C, math::Triple(increment.theta));
    const math::Triple mean = u + (1.0 / 6) * (theta - 2.0 * zeta).cross(u);
    return u - 0.5 * zeta.cross(mean);
}

/// Attitude after the step: the frame rotated by zeta (small: third order neglected), the body by theta. The change is computed
/// separately and added to q_rb, so that rounding does not accumulate where the rotations cancel (at rest on the rotating Earth):
/// products of full quaternions would drift by an ulp per step in one direction, 1e-12 rad/s at 10 kHz. The norm is restored by a
/// Newton step if it is off by more than rounding.
[[nodiscard]] inline math::Quad turned(const math::Quad& q_rb, const math::Triple& theta, const math::Triple& zeta) {
    const auto [cosine, sine_ratio] = math::half_angle(theta.squared_norm());
    const math::Triple half = sine_ratio * theta;
    const math::Quad body(-half.squared_norm() / (1.0 + cosine), half);  // minus one, without cancellation
    const math::Quad frame(-0.125 * zeta.squared_norm(), -0.5 * zeta);
    const math::Quad by_body = q_rb * body;
    const math::Quad q = q_rb + (by_body + frame * (q_rb + by_body));
    const double excess = q.squared_norm() - 1.0;
    return std::abs(excess) > 1e-15 ? (1.0 - 0.5 * excess) * q : q;
}

}  // namespace schuler::ins::detail
