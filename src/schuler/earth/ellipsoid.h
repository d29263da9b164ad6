// Ellipsoids as values, geodetic and Earth-fixed coordinates, radii of curvature.
#pragma once

#include "schuler/core/position.h"

#include <Eigen/Core>

#include <cmath>

namespace schuler::earth {

/// Reference ellipsoid with its rotation rate and geocentric gravitational constant. Passed by value, never a global.
struct Ellipsoid {
    double a;     ///< semi-major axis, m
    double f;     ///< flattening
    double gm;    ///< m^3/s^2
    double w_ie;  ///< rotation rate, rad/s

    [[nodiscard]] constexpr double e2() const { return f * (2.0 - f); }
    [[nodiscard]] constexpr double b() const { return a * (1.0 - f); }
};

inline constexpr Ellipsoid wgs84{6378137.0, 1.0 / 298.257223563, 3.986004418e14, 7.292115e-5};
inline constexpr Ellipsoid pz90{6378136.0, 1.0 / 298.257839303, 3.9860044e14, 7.292115e-5};
inline constexpr Ellipsoid pz90_11{6378136.0, 1.0 / 298.25784, 3.986004418e14, 7.292115e-5};
inline constexpr Ellipsoid krasovsky{6378245.0, 1.0 / 298.3, 3.986004418e14, 7.292115e-5};  ///< of SK-42
inline constexpr Ellipsoid international1924{6378388.0, 1.0 / 297.0, 3.986004418e14, 7.292115e-5};
/// Paper C, section 1: a, e^2 = 0.006692 and u = 7.29e-5 rad/s as printed; gm represents its g_eo a^2.
inline constexpr Ellipsoid paper_c{6378245.0, 0.0033516166671417311, 3.9788998494319171e14, 7.29e-5};

/// Radii of curvature at a latitude on the ellipsoid (without the height), m.
struct Radii {
    double meridian;
    double prime_vertical;
};
[[nodiscard]] Radii radii(const Ellipsoid& ellipsoid, double lat);
/// The same if the sine of the latitude is already known.
[[nodiscard]] inline Radii radii_at(const Ellipsoid& ellipsoid, double sin_lat) {
    const double e2 = ellipsoid.e2(), inverse_w2 = 1.0 / (1.0 - e2 * sin_lat * sin_lat);
    const double n = ellipsoid.a * std::sqrt(inverse_w2);
    return {n * (1.0 - e2) * inverse_w2, n};
}

/// Earth-fixed from geodetic, heights -12 km to 50 000 km: each component within 2 nm of the exact value below 100 km,
/// within 3e-16 of the geocentric distance above.
[[nodiscard]] Ecef ecef_from_geodetic(const Ellipsoid& ellipsoid, const Geodetic& position);
/// Geodetic from Earth-fixed, same range: latitude within 1e-15 rad of the exact value; height within 3 nm below 100 km,
/// within 5e-16 of the geocentric distance above. lon = atan2(y, x), 0 on the axis.
[[nodiscard]] Geodetic geodetic_from_ecef(const Ellipsoid& ellipsoid, const Ecef& position);

/// C_en: local-level (north-east-down) components to Earth-fixed components at a latitude and longitude (rad).
[[nodiscard]] Eigen::Matrix3d C_en(double lat, double lon);

}  // namespace schuler::earth
