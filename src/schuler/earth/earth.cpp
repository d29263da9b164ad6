#include "schuler/earth/earth.h"

#include "schuler/earth/detail/geodetic_trig.h"
#include "schuler/math/rotation.h"

#include <cmath>
#include <numbers>

namespace schuler::earth {

EarthTerms terms_at(const Earth& earth, const Geodetic& position, const Eigen::Vector3d& v_eb_n) {
    return terms_at(earth, std::sin(position.lat), std::cos(position.lat), position.h, v_eb_n);
}

EarthTerms terms_at(const Earth& earth, double s, double c, double h, const Eigen::Vector3d& v_eb_n) {
    const Ellipsoid& ell = earth.ellipsoid;
    const Radii radii = radii_at(ell, s);
    const GravityVector g = gravity_vector(earth.gravity, s, c, h);

    EarthTerms t;
    t.sin_lat = s;
    t.cos_lat = c;
    t.tan_lat = s / c;
    t.rm = radii.meridian + h;
    t.rn = radii.prime_vertical + h;
    t.w_ie_n = {ell.w_ie * c, 0.0, -ell.w_ie * s};
    const double east_rate = v_eb_n.y() / t.rn;
    t.w_en_n = {east_rate, -v_eb_n.x() / t.rm, -east_rate * t.tan_lat};
    t.g_n = {g.north, 0.0, g.down};
    return t;
}

Eigen::Vector3d gravity_ecef(const Earth& earth, const Ecef& position) {
    const detail::GeodeticTrig at = detail::geodetic_trig_from_ecef(earth.ellipsoid, position.r);
    const GravityVector g = gravity_vector(earth.gravity, at.sin_lat, at.cos_lat, at.h);
    const double outward = -g.north * at.sin_lat - g.down * at.cos_lat;  // away from the axis, in the equatorial plane
    return {outward * at.cos_lon, outward * at.sin_lon, g.north * at.cos_lat - g.down * at.sin_lat};
}

namespace {

/// Within 64 km of a pole longitude differences are not a measure of distance: the horizontal part is then that of the chord.
constexpr double polar_cos_lat = 0.01;

Eigen::Vector3d polar_difference(const Earth& earth, const Geodetic& to, const Geodetic& from) {
    const Eigen::Vector3d chord = ecef_from_geodetic(earth.ellipsoid, to).r - ecef_from_geodetic(earth.ellipsoid, from).r;
    const Eigen::Vector3d ned = C_en(from.lat, from.lon).transpose() * chord;
    return {ned.x(), ned.y(), from.h - to.h};
}

Geodetic moved_near_pole(const Earth& earth, const Geodetic& from, const Eigen::Vector3d& ned) {
    const Eigen::Matrix3d axes = C_en(from.lat, from.lon);
    Ecef at{ecef_from_geodetic(earth.ellipsoid, from).r};
    Geodetic to = from;
    // The chord drops below the horizon by at most 1e-4 of its length: each step gains four digits.
    for (int step = 0; step < 4; ++step) {
        to.h = from.h - ned.z();
        Eigen::Vector3d missing = ned - polar_difference(earth, to, from);
        missing.z() = 0.0;
        at.r = ecef_from_geodetic(earth.ellipsoid, to).r + axes * missing;
        to = geodetic_from_ecef(earth.ellipsoid, at);
    }
    to.h = from.h - ned.z();
    return to;
}

}  // namespace

Eigen::Vector3d ned_difference(const Earth& earth, const Geodetic& to, const Geodetic& from) {
    const double cos_lat = std::cos(from.lat);
    if (cos_lat < polar_cos_lat) return polar_difference(earth, to, from);
    const Radii r = radii(earth.ellipsoid, from.lat);
    double dlon = to.lon - from.lon;
    if (std::abs(dlon) > std::numbers::pi) dlon = math::wrap_pi(dlon);
    return {(to.lat - from.lat) * (r.meridian + from.h), dlon * (r.prime_vertical + from.h) * cos_lat, from.h - to.h};
}

Geodetic moved_by_ned(const Earth& earth, const Geodetic& from, const Eigen::Vector3d& ned) {
    const double cos_lat = std::cos(from.lat);
    if (cos_lat < polar_cos_lat) return moved_near_pole(earth, from, ned);
    const Radii r = radii(earth.ellipsoid, from.lat);
    double lon = from.lon + ned.y() / ((r.prime_vertical + from.h) * cos_lat);
    if (std::abs(lon) > std::numbers::pi) lon = math::wrap_pi(lon);
    return {from.lat + ned.x() / (r.meridian + from.h), lon, from.h - ned.z()};
}

}  // namespace schuler::earth
