// Start-up without hand-tuning: position, velocity, level, heading, mounting.
#pragma once

#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Finds the initial state from the data where the settings do not give it. Throws Error(Input) where there is nothing to start
/// from (no fix inside the IMU's time) and warns where the heading could not be found.
[[nodiscard]] Start find_start(const RunData& data, const Settings& settings, Findings& findings, WarningLog& warnings);

/// Vehicle axes to present body axes, from the direction of motion in body axes: C_vb. Identity and a warning where the vehicle
/// hardly moves.
struct MountingEstimate {
    Eigen::Matrix3d C_vb = Eigen::Matrix3d::Identity();
    Eigen::Vector3d std_rpy = Eigen::Vector3d::Zero();   ///< rad
    bool found = false;
};
[[nodiscard]] MountingEstimate estimate_mounting(const RunData& data, const Settings& settings, const Start& start);

}  // namespace schuler::fusion
