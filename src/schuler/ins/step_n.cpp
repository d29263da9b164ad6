#include "schuler/ins/step.h"

#include "schuler/ins/detail/turning_frame.h"
#include "schuler/math/rotation.h"

#include <cmath>
#include <numbers>

namespace schuler::ins {

using math::Quad;
using math::Triple;

NavState step_n(const earth::Earth& earth, const NavState& state, const CompensatedIncrement& increment) {
    const double dt = increment.dt;
    const Triple v(state.v_eb_n);
    const Quad q_nb(state.q_nb);

    // Position at mid-step, where the Earth terms are evaluated once; they do not depend on longitude. Half a step of latitude
    // requires only the first term of the radius series (8e-5), and no additional sine.
    const double s0 = std::sin(state.position.lat), c0 = std::cos(state.position.lat), e2 = earth.ellipsoid.e2();
    const double meridian = earth.ellipsoid.a * (1.0 - e2) * (1.0 + 1.5 * e2 * s0 * s0);
    const double half = 0.5 * dt * v.x / (meridian + state.position.h), half2 = half * half;
    const double cosine = 1.0 - 0.5 * half2, sine = half * (1.0 - half2 / 6.0);
    const double s = s0 * cosine + c0 * sine, c = c0 * cosine - s0 * sine, h = state.position.h - 0.5 * dt * v.z;
    const earth::Radii radii = earth::radii_at(earth.ellipsoid, s);
    const earth::GravityVector gravity = earth::gravity_vector(earth.gravity, s, c, h);
    const double by_rn = 1.0 / (radii.prime_vertical + h), by_rm = 1.0 / (radii.meridian + h), by_cos = 1.0 / c;
    const Triple w_ie(earth.ellipsoid.w_ie * c, 0.0, -earth.ellipsoid.w_ie * s), g(gravity.north, 0.0, gravity.down);
    const auto transport_rate = [&](const Triple& at) {
        const double east = at.y * by_rn;
        return Triple(east, -at.x * by_rm, -east * (s * by_cos));
    };

    // Velocity at mid-step: half of the step's change, for which the Coriolis term at the start is sufficient.
    const Triple w_en_start = transport_rate(v);
    const Triple dv = detail::velocity_increment_in(state.q_nb, increment, dt * (w_ie + w_en_start));
    const Triple v_middle = v + 0.5 * (dv + dt * (g - (2.0 * w_ie + w_en_start).cross(v)));
    const Triple w_en = transport_rate(v_middle);
    const Triple v_end = v + (dv + dt * (g - (2.0 * w_ie + w_en).cross(v_middle)));

    const Triple moved = 0.5 * dt * (v + v_end);
    double lon = state.position.lon + moved.y * by_rn * by_cos;
    if (std::abs(lon) > std::numbers::pi) lon = math::wrap_pi(lon);

    NavState next;
    next.time = increment.time;
    next.position = {state.position.lat + moved.x * by_rm, lon, state.position.h - moved.z};
    next.v_eb_n = v_end.vector();
    next.q_nb = detail::turned(q_nb, Triple(increment.theta), dt * (w_ie + w_en)).quaternion();
    return next;
}

}  // namespace schuler::ins
