// The angles between inertial unit and vehicle, from the direction of travel.
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// C_vb: present body axes to vehicle axes, from the direction of motion in body axes. Identity and a warning if the vehicle
/// hardly moves.
struct MountingEstimate {
    Eigen::Matrix3d C_vb = Eigen::Matrix3d::Identity();
    Eigen::Vector3d std_rpy = Eigen::Vector3d::Zero();  ///< rad
    bool found = false;
};
[[nodiscard]] MountingEstimate estimate_mounting(const RunData& data, const Settings& settings, const Start& start);

}  // namespace schuler::fusion
