#include "schuler/ins/step.h"

#include "schuler/ins/detail/turning_frame.h"

namespace schuler::ins {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using math::Quad;
using math::Triple;

NavStateEcef step_e(const earth::Earth& earth, const NavStateEcef& state, const CompensatedIncrement& increment) {
    const double dt = increment.dt;
    const Triple v(state.v_eb_e), start(state.position.r), zeta(0.0, 0.0, dt * earth.ellipsoid.w_ie);
    const Quad q_eb(state.q_eb);

    const Triple gravity(earth::gravity_ecef(earth, {(start + 0.5 * dt * v).vector()}));
    const Triple dv_g = detail::velocity_increment_in(state.q_eb, increment, zeta) + dt * gravity;
    const Triple v_middle = v + (0.5 * dv_g - zeta.cross(v));
    const Triple v_end = v + (dv_g - 2.0 * zeta.cross(v_middle));

    NavStateEcef next;
    next.time = increment.time;
    next.v_eb_e = v_end.vector();
    next.position.r = (start + 0.5 * dt * (v + v_end)).vector();
    next.q_eb = detail::turned(q_eb, Triple(increment.theta), zeta).quaternion();
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
