#include "schuler/ins/error_model.h"

#include "schuler/ins/detail/gravity_slope.h"
#include "schuler/math/rotation.h"

namespace schuler::ins {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

namespace {

/// Derivatives of the radii of curvature with respect to latitude, m/rad (math.md 2.3).
struct RadiiSlope {
    double meridian, prime_vertical;
};
RadiiSlope radii_slope(const earth::Ellipsoid& ellipsoid, const earth::EarthTerms& t, double h) {
    const double e2 = ellipsoid.e2();
    const double by_w2 = e2 * t.sin_lat * t.cos_lat / (1.0 - e2 * t.sin_lat * t.sin_lat);
    return {3.0 * (t.rm - h) * by_w2, (t.rn - h) * by_w2};
}

}  // namespace

Eigen::Matrix<double, 9, 9> matrix(const ErrorDynamics& d) {
    Eigen::Matrix<double, 9, 9> F = Eigen::Matrix<double, 9, 9>::Zero();
    F.block<3, 3>(0, 0) = d.pp;
    F.block<3, 3>(0, 3) = d.pv;
    F.block<3, 3>(3, 0) = d.vp;
    F.block<3, 3>(3, 3) = d.vv;
    F.block<3, 3>(3, 6) = d.va;
    F.block<3, 3>(6, 0) = d.ap;
    F.block<3, 3>(6, 3) = d.av;
    F.block<3, 3>(6, 6) = d.aa;
    return F;
}

Matrix3d level_rotation_by_displacement(const earth::EarthTerms& t) {
    Matrix3d L;
    L << 0.0, 1.0 / t.rn, 0.0, -1.0 / t.rm, 0.0, 0.0, 0.0, -t.tan_lat / t.rn, 0.0;
    return L;
}

ErrorDynamics error_n(const earth::Earth& earth, const Geodetic& position, const Vector3d& v_eb_n, const Vector3d& f_n) {
    return error_n(earth, earth::terms_at(earth, position, v_eb_n), position, v_eb_n, f_n);
}

ErrorDynamics error_n(const earth::Earth& earth, const earth::EarthTerms& t, const Geodetic& position, const Vector3d& v,
                      const Vector3d& f_n) {
    const RadiiSlope r = radii_slope(earth.ellipsoid, t, position.h);
    const double irm = 1.0 / t.rm, irn = 1.0 / t.rn;
    const double u = earth.ellipsoid.w_ie;
    const double vn = v.x(), ve = v.y(), vd = v.z();
    const double bend = t.tan_lat - r.prime_vertical * irn;  // d ln(1/(rn cos lat))/d lat

    ErrorDynamics d;
    // clang-format off
    d.pp << -vd * irm, 0.0, vn * irm,
            ve * irm * bend, -vd * irn - vn * irm * bend, ve * irn,
            0.0, 0.0, 0.0;
    // clang-format on
    d.pv.setIdentity();

    // Rates with respect to displacement: of the Earth's rotation, and of the transport rate.
    Matrix3d earth_rate = Matrix3d::Zero();
    earth_rate(0, 0) = -u * t.sin_lat * irm;
    earth_rate(2, 0) = -u * t.cos_lat * irm;
    const double ve2 = ve * irn * irn;
    const double vn2 = vn * irm * irm;
    Matrix3d transport = Matrix3d::Zero();
    transport(0, 0) = -ve2 * r.prime_vertical * irm;
    transport(0, 2) = ve2;
    transport(1, 0) = vn2 * r.meridian * irm;
    transport(1, 2) = -vn2;
    transport(2, 0) = -ve * irn * irm / (t.cos_lat * t.cos_lat) + ve2 * t.tan_lat * r.prime_vertical * irm;
    transport(2, 2) = -ve2 * t.tan_lat;

    const Matrix3d v_cross = skew(v);
    const Matrix3d level = level_rotation_by_displacement(t);
    const detail::GravitySlope g = detail::gravity_slope(earth.gravity, position.lat, position.h, t);
    d.vp = v_cross * (2.0 * earth_rate + transport);
    d.vp(0, 2) -= g.north_by_height;
    d.vp(2, 0) += g.down_by_lat * irm;
    d.vp(2, 2) -= g.down_by_height;
    d.vv = v_cross * level - skew(2.0 * t.w_ie_n + t.w_en_n);
    d.va = skew(f_n);

    d.ap = earth_rate + transport;
    d.av = level;
    d.aa = -skew(t.w_ie_n + t.w_en_n);
    return d;
}

}  // namespace schuler::ins
