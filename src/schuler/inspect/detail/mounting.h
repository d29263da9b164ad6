// Which way the sensor axes point: the vertical from gravity, forward from the direction of travel, both against an attitude log.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/inspect/detail/motion_fit.h"

#include <Eigen/Core>

#include <string>

namespace schuler::inspect::detail {

enum class ForwardFrom { Travel, AttitudeLog, Supposed };  ///< how forward was found

struct Mounting {
    bool found = false;                                     ///< at least the vertical is known
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();     ///< nearest permutation with signs, sensor to forward-right-down
    bool full = false;                                      ///< forward is known too: C_total is of the data
    Eigen::Matrix3d C_total = Eigen::Matrix3d::Identity();  ///< sensor to body as the data show it, axes and mounting together
    std::string axes;                                       ///< "frd", "flu", "fur" or "x=backward, y=right, z=up"
    Eigen::Vector3d rest_rpy = Eigen::Vector3d::Zero();     ///< roll, pitch, yaw from body to sensor after `axes`, rad
    double vertical_angle = 0.0;                            ///< between gravity and the nearest sensor axis, rad
    ForwardFrom forward_from = ForwardFrom::Supposed;
    double forward_spread = 0.0;  ///< of the direction of travel in sensor axes (one sigma of its angle), rad
    int epochs = 0;               ///< of travel or of attitude
    double confidence = 0.0;      ///< in `axes`
};

/// Travel seen from the sensor over the epochs of a fit.
struct Travel {
    int epochs = 0;
    double concentration = 0.0;                           ///< length of the mean unit vector: 1 = always along one sensor axis
    Eigen::Vector3d forward_s = Eigen::Vector3d::Zero();  ///< its direction, unit
    Eigen::Vector3d down_s = Eigen::Vector3d::Zero();     ///< mean vertical, unit
    double spread = 0.0;                                  ///< one sigma of the angle to forward_s, rad
    double tilt95 = 0.0;                                  ///< 95 % of the epochs tilt less than this from the mean vertical, rad
    double slope95 = 0.0;                                 ///< likewise the flight path above the horizon, rad
};
[[nodiscard]] Travel travel_of(const MotionFit& fit);

/// Rotation from sensor axes to the body axes of an attitude log, from rates: the log's attitude changes against the gyros.
struct AttitudeAgreement {
    bool found = false;
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();  ///< best rotation
    double correlation = 0.0;                            ///< of the rates after it
    int steps = 0;
};
[[nodiscard]] AttitudeAgreement attitude_agreement(const ImuSeries& imu, const Eigen::Vector3d& gyro_bias,
                                                   const std::vector<ReferenceSample>& reference, Time origin);

/// @param specific_force of the sensor at rest (or its long mean), m/s^2: points up; `at_rest` says which it is
[[nodiscard]] Mounting mounting_of(const Eigen::Vector3d& specific_force, bool at_rest, const Travel& travel,
                                   const AttitudeAgreement& attitude);

/// The same data seen from axes that are given: what remains is the mounting.
void take_axes(Mounting& mounting, const Eigen::Matrix3d& C_bs, const std::string& text);

}  // namespace schuler::inspect::detail
