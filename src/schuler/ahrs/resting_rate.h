// A gyro bias that is too large for the filters to distinguish from a rotation, found where the sensor rests.
#pragma once

#include "schuler/ahrs/settings.h"
#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <optional>
#include <span>

namespace schuler::ahrs {

/// Mean rate (rad/s, body) over the first 3 to 10 s of rest, if it is above what the filters take for rest. Rest: rate and specific force
/// stay constant, and so does the direction of the field. The force alone would not do: in a steady turn it is constant as well. Without
/// a magnetometer, or where the rate is along the field, no bias is found.
[[nodiscard]] std::optional<Eigen::Vector3d> resting_rate(std::span<const ImuSample> imu, std::span<const MagSample> mag,
                                                          const RestSettings& settings);

}  // namespace schuler::ahrs
