// Data accumulated by the strapdown part between two filter updates. Frame w is level and free in azimuth: its vertical is
// maintained by gravity, its heading by nothing, so the horizontal channel never requires the magnetometer.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace schuler::ahrs {

/// One block of inertial samples, as used by the channels.
struct Block {
    double duration = 0.0;                                      ///< s
    Eigen::Matrix3d C_wb = Eigen::Matrix3d::Zero();             ///< mean over the block
    Eigen::Vector3d rate_b = Eigen::Vector3d::Zero();           ///< rad/s, mean of the gyro as measured
    Eigen::Vector3d force_b = Eigen::Vector3d::Zero();          ///< m/s^2, mean
    Eigen::Vector3d force_w = Eigen::Vector3d::Zero();          ///< m/s^2, mean
    double turned = 0.0;                                        ///< rad, accumulated angle of rotation
    double doubt = 0.0;                                         ///< rad, possible rotation during excluded samples
    bool levelled = false;                                      ///< after a gap: the tilt was reset from the force
    Eigen::Quaterniond level = Eigen::Quaterniond::Identity();  ///< by this rotation of w
    bool force_known = false;                                   ///< at least half of the accelerometer samples were usable
    double rest_time = 0.0;                                     ///< s of rest so far; 0 in motion
    Eigen::Matrix2d P_tilt = Eigen::Matrix2d::Zero();           ///< rad^2, tilt covariance after the update, w axes
    Eigen::Matrix<double, 2, 3> tilt_of_accel_bias =
        Eigen::Matrix<double, 2, 3>::Zero();              ///< rad, tilt error per sigma of the accelerometer bias
    double tilt_kept = 1.0;                               ///< fraction of the tilt variance remaining after the update
    Eigen::Vector3d bias_used = Eigen::Vector3d::Zero();  ///< rad/s, gyro bias subtracted within the block
    double down_bias_std = 0.0;                           ///< rad/s, one sigma of its component along w's vertical
};

}  // namespace schuler::ahrs
