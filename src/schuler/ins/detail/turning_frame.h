// Shared by both mechanizations: resolution of an increment in a frame that rotates during the step.
#pragma once

#include "schuler/ins/increments.h"
#include "schuler/math/rotation.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace schuler::ins::detail {

/// Velocity increment in a frame r that rotates by zeta (rad, small) during the step, in the rotating axes of r: the
/// integral of Exp(-[zeta x] t/T) C_rb(0) C_b(0)b(t) f, to second order in the rotations. q_rb: attitude at the start.
/// With u = C_rb dv it is u - 1/2 zeta x (u + 1/6 (theta - 2 zeta) x u): exact to that order for constant rates, in particular
/// for a body at rest on the turning Earth.
[[nodiscard]] inline Eigen::Vector3d velocity_increment_in(const Eigen::Quaterniond& q_rb, const CompensatedIncrement& increment,
                                                           const Eigen::Vector3d& zeta) {
    const Eigen::Matrix3d C = q_rb.toRotationMatrix();  // cheaper than two rotations by the quaternion
    const Eigen::Vector3d u = C * increment.dv;
    const Eigen::Vector3d theta = C * increment.theta;
    const Eigen::Vector3d mean = u + (1.0 / 6) * (theta - 2.0 * zeta).cross(u);
    return u - 0.5 * zeta.cross(mean);
}

/// Attitude after the step: the frame rotated by zeta (small: third order neglected), the body by theta. The change is computed
/// separately and added to q_rb, so that rounding does not accumulate where the rotations cancel (at rest on the rotating Earth):
/// products of full quaternions would drift by an ulp per step in one direction, 1e-12 rad/s at 10 kHz. The norm is restored by a
/// Newton step if it is off by more than rounding.
[[nodiscard]] inline Eigen::Quaterniond turned(const Eigen::Quaterniond& q_rb, const Eigen::Vector3d& theta,
                                               const Eigen::Vector3d& zeta) {
    Eigen::Quaterniond body = math::quaternion_from_rotation_vector(theta);
    body.w() = -body.vec().squaredNorm() / (1.0 + body.w());  // minus one, without cancellation
    const Eigen::Quaterniond frame(-0.125 * zeta.squaredNorm(), -0.5 * zeta.x(), -0.5 * zeta.y(), -0.5 * zeta.z());
    Eigen::Quaterniond change = q_rb * body;
    Eigen::Quaterniond q(q_rb.coeffs() + change.coeffs());
    change.coeffs() += (frame * q).coeffs();
    q.coeffs() = q_rb.coeffs() + change.coeffs();
    const double excess = q.squaredNorm() - 1.0;
    if (std::abs(excess) > 1e-15) q.coeffs() *= 1.0 - 0.5 * excess;
    return q;
}

}  // namespace schuler::ins::detail
