#include "schuler/earth/ellipsoid.h"

#include "schuler/earth/detail/geodetic_trig.h"

#include <cmath>

namespace schuler::earth {

Radii radii(const Ellipsoid& ellipsoid, double lat) { return radii_at(ellipsoid, std::sin(lat)); }

Ecef ecef_from_geodetic(const Ellipsoid& ellipsoid, const Geodetic& position) {
    const double s = std::sin(position.lat), c = std::cos(position.lat);
    const double e2 = ellipsoid.e2();
    const double n = ellipsoid.a / std::sqrt(1.0 - e2 * s * s);
    const double p = (n + position.h) * c;
    return {{p * std::cos(position.lon), p * std::sin(position.lon), (n * (1.0 - e2) + position.h) * s}};
}

Geodetic geodetic_from_ecef(const Ellipsoid& ellipsoid, const Ecef& position) {
    const detail::GeodeticTrig g = detail::geodetic_trig_from_ecef(ellipsoid, position.r);
    return {std::atan2(g.sin_lat, g.cos_lat), std::atan2(position.r.y(), position.r.x()), g.h};
}

Eigen::Matrix3d C_en(double lat, double lon) {
    return detail::C_en_from_trig(std::sin(lat), std::cos(lat), std::sin(lon), std::cos(lon));
}

}  // namespace schuler::earth
