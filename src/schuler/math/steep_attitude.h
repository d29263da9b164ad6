// Attitude errors as three numbers when roll and heading rotate about nearly the same axis.
#pragma once

#include <Eigen/Core>

namespace schuler::math {

/// True if the pitch is within 10 degrees of the vertical, where the errors of roll and heading grow without bound.
[[nodiscard]] bool is_steep(const Eigen::Vector3d& rpy);

/// The change of the reported roll, pitch and heading for a small attitude error phi (local level, rad, the estimate rotated by -phi):
/// that of the angles themselves (rpy_error_from_phi); at steep pitch, the components of the rotation vector along the body x axis,
/// the level axis perpendicular to it, and the vertical, which remain as small as the rotation. @param rpy rad
[[nodiscard]] Eigen::Matrix3d attitude_error_from_phi(const Eigen::Vector3d& rpy);

}  // namespace schuler::math
