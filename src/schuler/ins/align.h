// Coarse alignment as pure functions: levelling, gyrocompassing, magnetic heading, attitude from specific force.
#pragma once

#include "schuler/core/position.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace schuler::ins {

/// Roll and pitch (rad) of a body at rest, with one sigma each.
struct Levelling {
    double roll, pitch;
    double std_roll, std_pitch;
};

/// Levelling by the mean specific force of a body at rest (m/s^2, body axes: down is negative when level; P. D. Groves,
/// 2nd ed., ch. 5.6.2). accel_std: one sigma of the mean of each axis, its bias included (m/s^2): std_pitch = accel_std/|f|,
/// std_roll is that divided by cos pitch. @throws Error(Input) if the force is zero or not finite.
[[nodiscard]] Levelling level(const Eigen::Vector3d& f_mean_b, double accel_std);

/// Attitude of a body at rest from gravity and the Earth's rotation.
struct Gyrocompass {
    Eigen::Quaterniond q_nb;
    Eigen::Vector3d rpy;      ///< roll, pitch, heading (0 to 2 pi), rad
    Eigen::Vector3d std_rpy;  ///< one sigma, rad
    double rate_misfit;       ///< measured minus expected magnitude of the rate, rad/s: not small means not at rest
    double vertical_misfit;   ///< measured minus expected down component of the rate, rad/s
};

/// Two-vector alignment: level by the specific force, heading by the horizontal component of the Earth rate. Means over a
/// standstill in body axes, m/s^2 and rad/s; gyro_std, accel_std: one sigma of the means of each axis, with biases. Predicted
/// sigma of heading when level: gyro_std/(w_ie cos lat) and accel_std tan(lat)/g, added in squares (K. R. Britting, "Inertial
/// navigation systems analysis", 1971, ch. 9: the tilt about north projects the vertical rate onto east).
/// @throws Error(Input) if a vector is zero or not finite, or |lat| >= 89.9 deg.
[[nodiscard]] Gyrocompass gyrocompass(const earth::Earth& earth, const Geodetic& position, const Eigen::Vector3d& f_mean_b,
                                      const Eigen::Vector3d& w_mean_b, double accel_std, double gyro_std);

/// True heading (0 to 2 pi) from the magnetic field in body axes (any unit), roll and pitch, and the declination (east positive).
[[nodiscard]] double heading_from_magnetometer(const Eigen::Vector3d& field_b, double roll, double pitch, double declination);

/// The rotation q_nb that takes the direction of f_b to that of f_n with the stated heading (rad) of the body x axis. Magnitudes
/// are ignored. With f_n off the vertical there may be two solutions: the one with the body z axis further down is used. If there
/// is none (body x axis closer to f_n than f_n to the vertical) the solution with the nearest heading is returned.
/// @throws Error(Input) if a force is zero or not finite.
[[nodiscard]] Eigen::Quaterniond attitude_from_specific_force(const Eigen::Vector3d& f_b, const Eigen::Vector3d& f_n,
                                                              double heading);

}  // namespace schuler::ins
