#include "schuler/ins/error_model.h"

#include "schuler/ins/detail/gravity_slope.h"
#include "schuler/math/rotation.h"

#include <algorithm>

namespace schuler::ins {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

namespace {

/// Gradient of the gravity vector in Earth-fixed axes, 1/s^2: C_en (dg_n/dr_n + the rotation of the local level under g_n) C_ne.
/// Written in local-level components that are finite at the poles, where g_north tan(lat) is finite too.
Matrix3d gravity_gradient_e(const earth::Earth& earth, const Ecef& position) {
    const Geodetic p = earth::geodetic_from_ecef(earth.ellipsoid, position);
    const earth::EarthTerms t = earth::terms_at(earth, p, Vector3d::Zero());
    const detail::GravitySlope slope = detail::gravity_slope(earth.gravity, p.lat, p.h, t);
    const double north = t.g_n.x(), down = t.g_n.z();
    Matrix3d G = Matrix3d::Zero();
    G(0, 0) = -down / t.rm;
    G(0, 2) = -slope.north_by_height;
    G(1, 1) = (-down - north * t.tan_lat) / t.rn;
    G(2, 0) = (slope.down_by_lat + north) / t.rm;
    G(2, 2) = -slope.down_by_height;
    const Matrix3d C_en = earth::C_en(p.lat, p.lon);
    return C_en * G * C_en.transpose();
}

}  // namespace

ErrorDynamics error_e(const earth::Earth& earth, const Ecef& position, const Vector3d& f_e) {
    const Matrix3d turn = skew(Vector3d(0.0, 0.0, earth.ellipsoid.w_ie));
    ErrorDynamics d;
    d.pp.setZero();
    d.pv.setIdentity();
    d.vp = gravity_gradient_e(earth, position);
    d.vv = -2.0 * turn;
    d.va = skew(f_e);
    d.ap.setZero();
    d.av.setZero();
    d.aa = -turn;
    return d;
}

Eigen::Matrix<double, 9, 9> geographic_from_ecef_errors(const earth::Earth& earth, const NavState& state) {
    earth::EarthTerms t = earth::terms_at(earth, state.position, state.v_eb_n);
    // North rotates with position by tan(lat) / R: a radian per metre at a metre from the pole, where it becomes undefined.
    t.tan_lat = std::clamp(t.tan_lat, -t.rn, t.rn);
    const Matrix3d C_ne = earth::C_en(state.position.lat, state.position.lon).transpose();
    const Matrix3d turn = level_rotation_by_displacement(t) * C_ne;
    Eigen::Matrix<double, 9, 9> M = Eigen::Matrix<double, 9, 9>::Zero();
    M.block<3, 3>(0, 0) = C_ne;
    M.block<3, 3>(3, 0) = skew(state.v_eb_n) * turn;
    M.block<3, 3>(3, 3) = C_ne;
    M.block<3, 3>(6, 0) = turn;
    M.block<3, 3>(6, 6) = C_ne;
    return M;
}

}  // namespace schuler::ins
