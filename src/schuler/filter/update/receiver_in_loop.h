// A receiver that navigates with the filter: it is given the motion of its antenna, and returns ranges.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/filter/update/receiver_aiding.h"

#include <functional>

namespace schuler::filter {

/// What the navigation supplies to the receiver at one time.
struct ReceiverAiding {
    Time time;
    EarthFixedMotion antenna;
    Eigen::Vector3d jerk_e = Eigen::Vector3d::Zero();  ///< m/s^3, of the specific force, which turns with the body
    Eigen::Matrix3d C_en;
    Eigen::Matrix<double, 6, 6> P = Eigen::Matrix<double, 6, 6>::Zero();  ///< position, velocity, north, east, down
    double clock = 0.0, drift = 0.0;  ///< c times the receiver's clock error, m, and its rate, m/s
    double std_clock = 0.0, std_drift = 0.0;
};

/// Listens from aiding.time up to `until` and appends the epochs that end there; times are those of the inertial log. In paper A's
/// aided and deep schemes (1.1) loops or generators follow the navigation.
using ReceiverInLoop = std::function<void(const ReceiverAiding& aiding, Time until, RangingLog& log)>;

}  // namespace schuler::filter
