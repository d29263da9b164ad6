// Pseudo-measurements: standing still, and wheels that do not slide.
#pragma once

#include "schuler/filter/measurement/measurement.h"

namespace schuler::filter {

/// Zero velocity relative to the Earth; std in m/s.
[[nodiscard]] Measurement zero_velocity(const Estimate& estimate, double std);

/// Zero rate relative to the Earth: the mean measured rate (rad/s, raw, body axes) is the gyro bias plus the Earth's rate.
[[nodiscard]] Measurement zero_rate(const Estimate& estimate, const Eigen::Vector3d& mean_raw_rate_b, double variance);

/// Non-holonomic constraint of a wheeled vehicle: no sideways and no vertical velocity, in vehicle axes, of the point of the
/// unsteered axle below the IMU's line. The vehicle's axes differ from the body's by the mounting states (pitch, yaw).
[[nodiscard]] Measurement nonholonomic(const Estimate& estimate, double std_lateral, double std_vertical);

/// Vehicle axes to body axes for small mounting errors: Rz(yaw) Ry(pitch).
[[nodiscard]] Eigen::Matrix3d body_from_vehicle(double pitch, double yaw);

}  // namespace schuler::filter
