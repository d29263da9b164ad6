// Information supplied by the navigation filter to a receiver's tracking loops: the interface of the deeper couplings.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

namespace schuler::filter {

/// Motion of a transmitter or of the antenna, Earth-fixed axes.
struct EarthFixedMotion {
    Eigen::Vector3d r_e;  ///< m
    Eigen::Vector3d v_e;  ///< m/s, relative to the Earth
    Eigen::Vector3d a_e;  ///< m/s^2, second derivative of r_e
};

/// Motion of the antenna from the inertial solution: specific force f_b (m/s^2) and rate w_ib_b (rad/s) already corrected. The
/// angular rate is assumed constant in the acceleration of the lever arm.
[[nodiscard]] EarthFixedMotion antenna_motion(const earth::Earth& earth, const NavState& nav, const Eigen::Vector3d& f_b,
                                              const Eigen::Vector3d& w_ib_b, const Eigen::Vector3d& lever_arm_b);

/// Data for a tracking loop to follow a signal through the antenna motion; clocks and light time are left to the loop.
struct LineOfSightPrediction {
    double range;         ///< m
    double rate;          ///< m/s
    double acceleration;  ///< m/s^2
    double std_range;     ///< m, from the navigation's covariance
    double std_rate;      ///< m/s
};

/// P: covariance of position and velocity of the antenna, north, east, down at the position of `nav`, 6 x 6.
[[nodiscard]] LineOfSightPrediction line_of_sight_prediction(const EarthFixedMotion& antenna, const EarthFixedMotion& transmitter,
                                                             const Eigen::Matrix3d& C_en, const Eigen::Matrix<double, 6, 6>& P);

}  // namespace schuler::filter
