// GNSS receiver, barometric altimeter and magnetometer along a truth path.
#pragma once

#include "schuler/sim/path.h"
#include "schuler/sim/simulate.h"

#include <vector>

namespace schuler::sim {

/// Position and velocity of a point fixed to the body.
struct PointMotion {
    Geodetic position;
    Eigen::Vector3d v_n;  ///< relative to the Earth, in the local level at the point, m/s
};

/// Motion of a point at a lever arm (body axes, m) from the IMU.
[[nodiscard]] PointMotion point_motion(const earth::Earth& earth, const Kinematics& imu, const Eigen::Vector3d& lever_arm_b);

/// The samples; `truth` receives the slowly varying error of each.
[[nodiscard]] std::vector<GnssFix> simulate_gnss(const Scenario& scenario, const TruthPath& path, std::vector<GnssTruth>& truth);
[[nodiscard]] std::vector<BaroSample> simulate_baro(const Scenario& scenario, const TruthPath& path,
                                                    std::vector<BaroTruth>& truth);
/// In sensor axes.
[[nodiscard]] std::vector<MagSample> simulate_mag(const Scenario& scenario, const TruthPath& path);

}  // namespace schuler::sim
