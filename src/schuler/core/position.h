// A separate type for each kind of position, so that a field keeps one meaning.
#pragma once

#include <Eigen/Core>

namespace schuler {

/// Geodetic position on the ellipsoid in use: latitude and longitude in rad, ellipsoidal height in m.
struct Geodetic {
    double lat = 0.0;
    double lon = 0.0;
    double h = 0.0;
};

/// Earth-centred Earth-fixed position, m.
struct Ecef {
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
};

/// Position relative to a stated origin in its north-east-down frame, m.
struct Ned {
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
};

}  // namespace schuler
