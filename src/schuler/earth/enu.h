// East-north-up, used at the interfaces, and north-east-down, used internally.
#pragma once

#include <Eigen/Core>

namespace schuler::earth {

[[nodiscard]] inline Eigen::Vector3d ned_from_enu(const Eigen::Vector3d& enu) { return {enu.y(), enu.x(), -enu.z()}; }
[[nodiscard]] inline Eigen::Vector3d enu_from_ned(const Eigen::Vector3d& ned) { return {ned.y(), ned.x(), -ned.z()}; }
/// The same for sigmas, which have no sign, in both directions.
[[nodiscard]] inline Eigen::Vector3d sigma_swapped(const Eigen::Vector3d& sigma) { return {sigma.y(), sigma.x(), sigma.z()}; }

}  // namespace schuler::earth
