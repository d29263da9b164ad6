// Slowly varying errors of a GNSS receiver's own solution, which white noise does not describe.
#pragma once

#include <Eigen/Core>

namespace schuler::sensor {

/// Slowly varying errors of a receiver's position and velocity, north, east, down, one sigma, SI units; paper A's (3.2.2). Each
/// component is a stationary first-order Gauss-Markov process; that of the position decorrelates with time and with the distance
/// flown over the ground: correlation exp(-(dt/time + ds/distance)). When the set of satellites changes, the process and the
/// white noise of that fix receive an additional step. All zero: white noise only.
struct GnssErrorModel {
    Eigen::Vector3d correlated_position = Eigen::Vector3d::Zero();  ///< m
    double correlated_time = 300.0;                                 ///< s, 1/lambda_st of the paper
    double correlated_distance = 0.0;                               ///< m, 1/lambda_s; 0: no dependence on distance
    Eigen::Vector3d correlated_velocity = Eigen::Vector3d::Zero();  ///< m/s
    double correlated_velocity_time = 300.0;                        ///< s, 1/lambda_V

    Eigen::Vector3d change_white_position = Eigen::Vector3d::Zero();       ///< m, at a change of constellation
    Eigen::Vector3d change_correlated_position = Eigen::Vector3d::Zero();  ///< m
    Eigen::Vector3d change_white_velocity = Eigen::Vector3d::Zero();       ///< m/s
    Eigen::Vector3d change_correlated_velocity = Eigen::Vector3d::Zero();  ///< m/s

    /// Decay rate of the position process (1/s) at a ground speed in m/s.
    [[nodiscard]] double position_decay(double ground_speed) const {
        return 1.0 / correlated_time + (correlated_distance > 0.0 ? ground_speed / correlated_distance : 0.0);
    }
};

}  // namespace schuler::sensor
