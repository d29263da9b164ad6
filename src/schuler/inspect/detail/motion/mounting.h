// Directions of the sensor axes: the vertical from gravity, forward from the direction of travel, or both from an attitude log.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/inspect/detail/motion/motion_fit.h"

#include <Eigen/Core>

#include <string>

namespace schuler::inspect::detail {

enum class ForwardFrom { Travel, AttitudeLog, Supposed };  ///< how forward was determined

struct Mounting {
    bool found = false;                                     ///< at least the vertical is known
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();     ///< nearest signed permutation, sensor to forward-right-down
    bool full = false;                                      ///< forward is known too: C_total is determined from the data
    Eigen::Matrix3d C_total = Eigen::Matrix3d::Identity();  ///< sensor to body as found from the data, axes and mounting combined
    std::string axes;                                       ///< "frd", "flu", "fur" or "x=backward, y=right, z=up"
    Eigen::Vector3d rest_rpy = Eigen::Vector3d::Zero();     ///< roll, pitch, yaw from body to sensor after `axes`, rad
    double vertical_angle = 0.0;                            ///< between gravity and the nearest sensor axis, rad
    ForwardFrom forward_from = ForwardFrom::Supposed;
    double forward_spread = 0.0;  ///< of the direction of travel in sensor axes (one sigma of its angle), rad
    int epochs = 0;               ///< of travel or of attitude
    double confidence = 0.0;      ///< in `axes`
};

/// Direction of travel in sensor axes over the epochs of a fit.
struct Travel {
    int epochs = 0;
    double concentration = 0.0;                           ///< length of the mean unit vector: 1 = always along one sensor axis
    Eigen::Vector3d forward_s = Eigen::Vector3d::Zero();  ///< its direction, unit
    Eigen::Vector3d down_s = Eigen::Vector3d::Zero();     ///< mean vertical, unit
    double spread = 0.0;                                  ///< one sigma of the angle to forward_s, rad
    double tilt95 = 0.0;   ///< 95 % of the epochs are tilted by less than this from the mean vertical, rad
    double slope95 = 0.0;  ///< likewise for the flight path angle, rad
};
[[nodiscard]] Travel travel_of(const MotionFit& fit);

/// Rotation from sensor axes to the body axes of an attitude log, from the log's attitude changes compared with the gyros.
struct AttitudeAgreement {
    bool found = false;
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();  ///< best rotation
    double correlation = 0.0;                            ///< of the rates after it
    int steps = 0;
};
[[nodiscard]] AttitudeAgreement attitude_agreement(const ImuSeries& imu, const Eigen::Vector3d& gyro_bias,
                                                   const std::vector<ReferenceSample>& reference, Time origin);

/// @param specific_force of the sensor at rest (or its long-term mean), m/s^2: points up; `at_rest` distinguishes them
[[nodiscard]] Mounting mounting_of(const Eigen::Vector3d& specific_force, bool at_rest, const Travel& travel,
                                   const AttitudeAgreement& attitude);

/// Applies given axes to the same data: the remainder is the mounting.
void take_axes(Mounting& mounting, const Eigen::Matrix3d& C_bs, const std::string& text);

}  // namespace schuler::inspect::detail
