// The angles between the inertial unit and its vehicle, from the direction of travel.
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Vehicle axes to present body axes, from the direction of motion in body axes: C_vb. Identity and a warning where the vehicle
/// hardly moves.
struct MountingEstimate {
    Eigen::Matrix3d C_vb = Eigen::Matrix3d::Identity();
    Eigen::Vector3d std_rpy = Eigen::Vector3d::Zero();  ///< rad
    bool found = false;
};
[[nodiscard]] MountingEstimate estimate_mounting(const RunData& data, const Settings& settings, const Start& start);

}  // namespace schuler::fusion
