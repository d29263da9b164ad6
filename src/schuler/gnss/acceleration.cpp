#include "schuler/gnss/acceleration.h"

#include <Eigen/Geometry>

#include <cmath>

namespace schuler::gnss {

Eigen::Vector3d point_mass_acceleration(const SatelliteState& s, const earth::Ellipsoid& earth) {
    const Eigen::Vector3d axis(0.0, 0.0, earth.w_ie);
    const Eigen::Vector3d r = s.position.r, v = s.velocity;
    return -earth.gm / std::pow(r.norm(), 3) * r - 2.0 * axis.cross(v) - axis.cross(axis.cross(r));
}

}  // namespace schuler::gnss
