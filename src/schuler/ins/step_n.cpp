#include "schuler/ins/step.h"

#include "schuler/ins/detail/turning_frame.h"
#include "schuler/math/rotation.h"

#include <cmath>
#include <numbers>

namespace schuler::ins {

using Eigen::Vector3d;

NavState step_n(const earth::Earth& earth, const NavState& state, const CompensatedIncrement& increment) {
    const double dt = increment.dt;
    const Vector3d& v = state.v_eb_n;

    // Position at mid-step, where the Earth terms are evaluated once; they do not depend on longitude. Half a step of latitude
    // requires only the first term of the radius series (8e-5), and no additional sine.
    const double s0 = std::sin(state.position.lat), c0 = std::cos(state.position.lat), e2 = earth.ellipsoid.e2();
    const double meridian = earth.ellipsoid.a * (1.0 - e2) * (1.0 + 1.5 * e2 * s0 * s0);
    const double half = 0.5 * dt * v.x() / (meridian + state.position.h), half2 = half * half;
    const double cosine = 1.0 - 0.5 * half2, sine = half * (1.0 - half2 / 6.0);
    const earth::EarthTerms terms =
        earth::terms_at(earth, s0 * cosine + c0 * sine, c0 * cosine - s0 * sine, state.position.h - 0.5 * dt * v.z(), v);

    // Velocity at mid-step: half of the step's change, for which the Coriolis term at the start is sufficient.
    const Vector3d zeta_start = dt * (terms.w_ie_n + terms.w_en_n);
    const Vector3d dv_n = detail::velocity_increment_in(state.q_nb, increment, zeta_start);
    const Vector3d v_middle = v + 0.5 * (dv_n + dt * (terms.g_n - (2.0 * terms.w_ie_n + terms.w_en_n).cross(v)));
    const double by_rn = 1.0 / terms.rn, by_rm = 1.0 / terms.rm;  // divisions dominate the cost of this step
    const double east_rate = v_middle.y() * by_rn;
    const Vector3d w_en_n(east_rate, -v_middle.x() * by_rm, -east_rate * terms.tan_lat);

    NavState next;
    next.time = increment.time;
    next.v_eb_n = v + dv_n + dt * (terms.g_n - (2.0 * terms.w_ie_n + w_en_n).cross(v_middle));

    const Vector3d moved = 0.5 * dt * (v + next.v_eb_n);
    double lon = state.position.lon + moved.y() * by_rn / terms.cos_lat;
    if (std::abs(lon) > std::numbers::pi) lon = math::wrap_pi(lon);
    next.position = {state.position.lat + moved.x() * by_rm, lon, state.position.h - moved.z()};

    next.q_nb = detail::turned(state.q_nb, increment.theta, dt * (terms.w_ie_n + w_en_n));
    return next;
}

}  // namespace schuler::ins
