#include "schuler/ins/step.h"

#include "schuler/ins/detail/turning_frame.h"

namespace schuler::ins {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

NavStateEcef step_e(const earth::Earth& earth, const NavStateEcef& state, const CompensatedIncrement& increment) {
    const double dt = increment.dt;
    const Vector3d& v = state.v_eb_e;
    const Vector3d w_ie_e(0.0, 0.0, earth.ellipsoid.w_ie);
    const Vector3d zeta = dt * w_ie_e;

    const Ecef middle{state.position.r + 0.5 * dt * v};
    const Vector3d dv_g = detail::velocity_increment_in(state.q_eb, increment, zeta) + dt * earth::gravity_ecef(earth, middle);
    const Vector3d v_middle = v + 0.5 * dv_g - zeta.cross(v);

    NavStateEcef next;
    next.time = increment.time;
    next.v_eb_e = v + dv_g - 2.0 * zeta.cross(v_middle);
    next.position.r = state.position.r + 0.5 * dt * (v + next.v_eb_e);
    next.q_eb = detail::turned(state.q_eb, increment.theta, zeta);
    return next;
}

NavStateEcef to_ecef(const earth::Earth& earth, const NavState& state) {
    const Matrix3d C_en = earth::C_en(state.position.lat, state.position.lon);
    NavStateEcef s;
    s.time = state.time;
    s.position = earth::ecef_from_geodetic(earth.ellipsoid, state.position);
    s.v_eb_e = C_en * state.v_eb_n;
    s.q_eb = Quaterniond(C_en) * state.q_nb;
    return s;
}

NavState to_geographic(const earth::Earth& earth, const NavStateEcef& state) {
    NavState s;
    s.time = state.time;
    s.position = earth::geodetic_from_ecef(earth.ellipsoid, state.position);
    const Matrix3d C_ne = earth::C_en(s.position.lat, s.position.lon).transpose();
    s.v_eb_n = C_ne * state.v_eb_e;
    s.q_nb = Quaterniond(C_ne) * state.q_eb;
    return s;
}

}  // namespace schuler::ins
