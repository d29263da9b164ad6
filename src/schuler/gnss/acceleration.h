// The acceleration of a satellite where no model of its orbit is asked again.
#pragma once

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/orbit.h"

#include <Eigen/Core>

namespace schuler::gnss {

/// Relative to the Earth, Earth-fixed axes, m/s^2: the field of a point mass with the Coriolis and centrifugal terms, within 1e-4 m/s^2 of
/// the field with its flattening.
[[nodiscard]] Eigen::Vector3d point_mass_acceleration(const SatelliteState& satellite, const earth::Ellipsoid& earth);

}  // namespace schuler::gnss
