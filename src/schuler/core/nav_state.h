// The navigation solution, integrated by mechanizations and estimated by filters.
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/time.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace schuler {

/// Geographic-frame state: local level is north-east-down, body forward-right-down.
struct NavState {
    Time time;
    Geodetic position;
    Eigen::Vector3d v_eb_n = Eigen::Vector3d::Zero();          ///< m/s
    Eigen::Quaterniond q_nb = Eigen::Quaterniond::Identity();  ///< body to local level, Hamilton
};

/// Earth-fixed-frame state.
struct NavStateEcef {
    Time time;
    Ecef position;
    Eigen::Vector3d v_eb_e = Eigen::Vector3d::Zero();          ///< m/s
    Eigen::Quaterniond q_eb = Eigen::Quaterniond::Identity();  ///< body to Earth-fixed, Hamilton
};

/// One reported epoch of a solution: state and one sigma of each component.
struct SolutionRow {
    Time time;
    Geodetic position;             ///< of the IMU
    Eigen::Vector3d v_eb_n;        ///< m/s
    Eigen::Vector3d rpy;           ///< roll, pitch, heading (0 to 2 pi), rad
    Eigen::Vector3d std_position;  ///< north, east, down, m
    Eigen::Vector3d std_velocity;  ///< north, east, down, m/s
    Eigen::Vector3d std_rpy;       ///< rad
};

}  // namespace schuler
