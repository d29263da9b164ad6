// A receiver in closed loop with the filter: it receives the motion of its antenna, and returns ranges.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/filter/update/receiver_aiding.h"

#include <functional>

namespace schuler::filter {

/// Data supplied by the navigation to the receiver at one instant.
struct ReceiverAiding {
    Time time;
    EarthFixedMotion antenna;
    Eigen::Vector3d jerk_e = Eigen::Vector3d::Zero();  ///< m/s^3, of the specific force, which rotates with the body
    Eigen::Matrix3d C_en;
    Eigen::Matrix<double, 6, 6> P = Eigen::Matrix<double, 6, 6>::Zero();  ///< position, velocity, north, east, down
    double clock = 0.0, drift = 0.0;  ///< c times the receiver's clock error, m, and its rate, m/s
    double std_clock = 0.0, std_drift = 0.0;
};

/// Tracks from aiding.time to `until` and appends the epochs that end in this interval; times are those of the inertial log. In
/// the aided and deep schemes of paper A (1.1), loops or generators follow the navigation.
using ReceiverInLoop = std::function<void(const ReceiverAiding& aiding, Time until, RangingLog& log)>;

}  // namespace schuler::filter
