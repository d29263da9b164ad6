// Rotation from the axes of the magnetometer to those of the inertial unit, if the settings distinguish them.
#pragma once

#include "schuler/settings/config/config.h"

#include <Eigen/Core>

#include <optional>

namespace schuler::settings {

/// C of field_imu = C field_mag; empty if `mag.axes` is not given: both have the same axes. The filter rotates the field from the
/// unit's axes to those of the body with the unit's own axes and mounting.
[[nodiscard]] std::optional<Eigen::Matrix3d> C_imu_mag(const Config& config);

}  // namespace schuler::settings
