#include "schuler/filter/update/receiver_aiding.h"

#include <cmath>

namespace schuler::filter {

using Eigen::Vector3d;

EarthFixedMotion antenna_motion(const earth::Earth& earth, const NavState& nav, const Vector3d& f_b, const Vector3d& w_ib_b,
                                const Vector3d& lever_arm_b) {
    const Eigen::Matrix3d C_en = earth::C_en(nav.position.lat, nav.position.lon);
    const Eigen::Matrix3d C_eb = C_en * nav.q_nb.toRotationMatrix();
    const Vector3d w_ie(0.0, 0.0, earth.ellipsoid.w_ie);
    EarthFixedMotion m;
    const Ecef imu = earth::ecef_from_geodetic(earth.ellipsoid, nav.position);
    const Vector3d v = C_en * nav.v_eb_n;
    const Vector3d w_eb = C_eb * w_ib_b - w_ie, arm = C_eb * lever_arm_b;
    m.r_e = imu.r + arm;
    m.v_e = v + w_eb.cross(arm);
    // r'' in Earth-fixed axes: specific force, gravity (with the centrifugal part), Coriolis.
    m.a_e = C_eb * f_b + earth::gravity_ecef(earth, imu) - 2.0 * w_ie.cross(v) + w_eb.cross(w_eb.cross(arm));
    return m;
}

LineOfSightPrediction line_of_sight_prediction(const EarthFixedMotion& antenna, const EarthFixedMotion& transmitter,
                                               const Eigen::Matrix3d& C_en, const Eigen::Matrix<double, 6, 6>& P) {
    const Vector3d dr = antenna.r_e - transmitter.r_e, dv = antenna.v_e - transmitter.v_e, da = antenna.a_e - transmitter.a_e;
    LineOfSightPrediction seen{};
    seen.range = dr.norm();
    const Vector3d u = dr / seen.range;
    seen.rate = u.dot(dv);
    seen.acceleration = u.dot(da) + (dv.squaredNorm() - seen.rate * seen.rate) / seen.range;
    const Vector3d u_n = C_en.transpose() * u;
    seen.std_range = std::sqrt(u_n.dot(P.topLeftCorner<3, 3>() * u_n));
    seen.std_rate = std::sqrt(u_n.dot(P.bottomRightCorner<3, 3>() * u_n));
    return seen;
}

}  // namespace schuler::filter
