// Rotations: C_ab takes components in b to components in a; quaternions are Hamilton with the same letters.
#pragma once

#include "schuler/math/triple.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace schuler::math {

/// [v x], so that skew(a) * b = a x b.
[[nodiscard]] inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
}

/// Exp([r x]): the rotation matrix of a rotation vector r (rad). Relative error below 1e-15 at every |r|.
[[nodiscard]] Eigen::Matrix3d dcm_from_rotation_vector(const Eigen::Vector3d& r);

/// Unit quaternion of a rotation vector (rad), w = cos(|r|/2).
[[nodiscard]] inline Eigen::Quaterniond quaternion_from_rotation_vector(const Eigen::Vector3d& r) {
    const auto [c, s] = half_angle(r.x() * r.x() + r.y() * r.y() + r.z() * r.z());
    return {c, s * r.x(), s * r.y(), s * r.z()};
}

/// Rotation vector (rad, |r| <= pi) of a unit quaternion; q and -q give the same.
[[nodiscard]] Eigen::Vector3d rotation_vector_from_quaternion(const Eigen::Quaterniond& q);

/// C_nb from roll, pitch, heading (rad): body forward-right-down to north-east-down.
[[nodiscard]] Eigen::Matrix3d dcm_from_rpy(const Eigen::Vector3d& rpy);
[[nodiscard]] Eigen::Quaterniond quaternion_from_rpy(const Eigen::Vector3d& rpy);

/// Roll (-pi, pi], pitch [-pi/2, pi/2], heading [0, 2 pi), rad, of C_nb. At |pitch| = 90 deg (within about 1e-7 rad) roll is
/// set to zero and the heading carries the remaining rotation.
[[nodiscard]] Eigen::Vector3d rpy_from_dcm(const Eigen::Matrix3d& C_nb);
[[nodiscard]] Eigen::Vector3d rpy_from_quaternion(const Eigen::Quaterniond& q_nb);

/// d(rpy)/d(phi) for C_nb_est = (I - [phi x]) C_nb: maps the attitude error phi (local-level axes) to estimate-minus-truth
/// errors of roll, pitch and heading. Singular at |pitch| = 90 deg (returns large finite values there).
[[nodiscard]] Eigen::Matrix3d rpy_error_from_phi(const Eigen::Vector3d& rpy);

/// Nearest rotation matrix after small numerical drift: one Newton step of the polar decomposition.
[[nodiscard]] inline Eigen::Matrix3d orthonormalised(const Eigen::Matrix3d& C) {
    const Eigen::Matrix3d excess = C.transpose() * C - Eigen::Matrix3d::Identity();
    return C - 0.5 * C * excess;
}

/// Angle in (-pi, pi].
[[nodiscard]] double wrap_pi(double angle);
/// Angle in [0, 2 pi).
[[nodiscard]] double wrap_2pi(double angle);

}  // namespace schuler::math
