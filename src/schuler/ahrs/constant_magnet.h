// A magnet or iron that is fixed to a magnetometer throughout a log: a constant field in all readings, determined by rotation.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <optional>
#include <span>

namespace schuler::ahrs {

struct ConstantMagnet {
    Eigen::Vector3d field_b = Eigen::Vector3d::Zero();  ///< T
    double std = 0.0;                                   ///< T, one sigma of its least known component
};

/// Readings in body axes. Nothing if the field is less than 10 uT, which the filters expect and find, if the sensor turns too little,
/// or if the parts of the log do not agree: a magnet that comes and goes is not constant.
[[nodiscard]] std::optional<ConstantMagnet> find_constant_magnet(std::span<const ImuSample> imu, std::span<const MagSample> mag);

}  // namespace schuler::ahrs
