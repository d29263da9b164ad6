// What the strapdown part gathers between two filter updates. Frame w is level and free in azimuth: gravity holds its vertical,
// nothing holds its heading, so the horizontal channel never needs the magnetometer.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace schuler::ahrs {

/// One block of inertial samples, as the channels see it.
struct Block {
    double duration = 0.0;                                      ///< s
    Eigen::Matrix3d C_wb = Eigen::Matrix3d::Zero();             ///< mean over the block
    Eigen::Vector3d rate_b = Eigen::Vector3d::Zero();           ///< rad/s, mean of the gyro as measured
    Eigen::Vector3d force_b = Eigen::Vector3d::Zero();          ///< m/s^2, mean
    Eigen::Vector3d force_w = Eigen::Vector3d::Zero();          ///< m/s^2, mean
    double turned = 0.0;                                        ///< rad, length of the path of rotation
    double doubt = 0.0;                                         ///< rad, by which samples that were left out may have turned it
    bool levelled = false;                                      ///< after a gap: the tilt was taken from the force anew
    Eigen::Quaterniond level = Eigen::Quaterniond::Identity();  ///< by this rotation of w
    bool force_known = false;                                   ///< at least half of the accelerometer samples were usable
    double rest_time = 0.0;                                     ///< s of rest so far; 0 in motion
    Eigen::Matrix2d P_tilt = Eigen::Matrix2d::Zero();           ///< rad^2, tilt covariance after the update, w axes
    double tilt_kept = 1.0;                                     ///< how much of the tilt's variance the update left
    Eigen::Vector3d bias_used = Eigen::Vector3d::Zero();        ///< rad/s, gyro bias taken off within the block
    double down_bias_std = 0.0;                                 ///< rad/s, one sigma of its component along w's vertical
};

}  // namespace schuler::ahrs
