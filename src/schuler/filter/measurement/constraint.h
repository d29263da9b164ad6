// Pseudo-measurements: zero velocity, and wheels without side slip.
#pragma once

#include "schuler/filter/measurement/measurement.h"

namespace schuler::filter {

/// Zero velocity relative to the Earth; std in m/s.
[[nodiscard]] Measurement zero_velocity(const Estimate& estimate, double std);

/// Zero rate relative to the Earth: the mean measured rate (rad/s, raw, body axes) equals the gyro bias plus the Earth rate.
[[nodiscard]] Measurement zero_rate(const Estimate& estimate, const Eigen::Vector3d& mean_raw_rate_b, double variance);

/// Non-holonomic constraint of a wheeled vehicle: zero lateral and vertical velocity, in vehicle axes, of the point at the
/// unsteered axle on the IMU's longitudinal axis. The vehicle axes differ from the body axes by the mounting states (pitch, yaw).
[[nodiscard]] Measurement nonholonomic(const Estimate& estimate, double std_lateral, double std_vertical);

/// Vehicle axes to body axes for small mounting errors: Rz(yaw) Ry(pitch).
[[nodiscard]] Eigen::Matrix3d body_from_vehicle(double pitch, double yaw);

}  // namespace schuler::filter
