// The Earth as a value, and the Earth terms of one epoch shared by mechanization and error model.
#pragma once

#include "schuler/core/position.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/earth/gravity.h"

#include <Eigen/Core>

namespace schuler::earth {

/// Ellipsoid, rotation and gravity model. Simulator and filter must use the same one, except in studies of the difference.
struct Earth {
    Ellipsoid ellipsoid = wgs84;
    GravityModel gravity = GravityModel::Somigliana;
};

/// Earth terms at a position and velocity, north-east-down. cos and tan of latitude are computed only here.
struct EarthTerms {
    double sin_lat, cos_lat, tan_lat;
    double rm, rn;           ///< meridian and prime-vertical radius plus height, m
    Eigen::Vector3d w_ie_n;  ///< rad/s
    Eigen::Vector3d w_en_n;  ///< transport rate, rad/s
    Eigen::Vector3d g_n;     ///< gravity vector, m/s^2 (positive down; north component as defined by GravityModel, east zero)
};

/// Terms at a geodetic position with Earth-relative velocity (NED, m/s). Poles excluded: |lat| < pi/2 - 1e-6.
[[nodiscard]] EarthTerms terms_at(const Earth& earth, const Geodetic& position, const Eigen::Vector3d& v_eb_n);
/// The same if sine and cosine of the latitude are already known.
[[nodiscard]] EarthTerms terms_at(const Earth& earth, double sin_lat, double cos_lat, double h, const Eigen::Vector3d& v_eb_n);

/// Gravity vector (gravitation plus centrifugal) in Earth-fixed axes at an Earth-fixed position, m/s^2: equal to the rotated g_n of
/// terms_at at the same position to rounding, for every model. Valid at the poles.
[[nodiscard]] Eigen::Vector3d gravity_ecef(const Earth& earth, const Ecef& position);

/// Metres north, east, down from `from` to `to` for nearby points, linear in the angles with the radii at `from`; the longitude
/// wraps. Relative to distances on the surface the error at distance d is about d^2 tan(lat)/6400 km: 1 mm at 80 m, 45 deg; the
/// down component is the exact height difference (no curvature drop). Poles excluded.
[[nodiscard]] Eigen::Vector3d ned_difference(const Earth& earth, const Geodetic& to, const Geodetic& from);
/// Position displaced by metres north, east, down: the inverse of ned_difference(result, from) to rounding; lon in [-pi, pi].
[[nodiscard]] Geodetic moved_by_ned(const Earth& earth, const Geodetic& from, const Eigen::Vector3d& ned);

}  // namespace schuler::earth
