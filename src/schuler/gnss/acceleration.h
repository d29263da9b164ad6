// Satellite acceleration without further evaluation of the orbit model.
#pragma once

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/orbit.h"

#include <Eigen/Core>

namespace schuler::gnss {

/// Relative to the Earth, Earth-fixed axes, m/s^2: point-mass gravitation with the Coriolis and centrifugal terms; the neglected
/// flattening contributes less than 1e-4 m/s^2.
[[nodiscard]] Eigen::Vector3d point_mass_acceleration(const SatelliteState& satellite, const earth::Ellipsoid& earth);

}  // namespace schuler::gnss
