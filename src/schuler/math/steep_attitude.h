// Attitude errors as three numbers where roll and heading turn about nearly the same axis.
#pragma once

#include <Eigen/Core>

namespace schuler::math {

/// Whether the pitch is within 10 degrees of the vertical, where errors of roll and heading grow beyond every bound.
[[nodiscard]] bool is_steep(const Eigen::Vector3d& rpy);

/// The change of roll, pitch and heading reported for a small attitude error phi (local level, rad, the estimate turned by -phi): that
/// of the angles themselves (rpy_error_from_phi); where the pitch is steep, the parts of the rotation vector about the body's x axis,
/// the level axis across it, and the vertical, which stay as small as the rotation is. @param rpy rad
[[nodiscard]] Eigen::Matrix3d attitude_error_from_phi(const Eigen::Vector3d& rpy);

}  // namespace schuler::math
