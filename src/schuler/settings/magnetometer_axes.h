// From the axes of the magnetometer to those of the inertial unit, where the settings tell them apart.
#pragma once

#include "schuler/settings/config/config.h"

#include <Eigen/Core>

#include <optional>

namespace schuler::settings {

/// C of field_imu = C field_mag; nothing where `mag.axes` is not given: both have the same axes. The filter turns the field of the unit's
/// axes to those of the body with the unit's own axes and mounting.
[[nodiscard]] std::optional<Eigen::Matrix3d> C_imu_mag(const Config& config);

}  // namespace schuler::settings
