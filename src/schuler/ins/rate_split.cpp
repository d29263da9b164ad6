#include "schuler/ins/rate_split.h"

#include "schuler/earth/axes.h"
#include "schuler/math/rotation.h"

namespace schuler::ins::paper_a {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// (N, E, D) or (forward, right, down) to the paper's (N, up, E) or (forward, up, right).
Vector3d to_paper(const Vector3d& v) { return {v.x(), -v.z(), v.y()}; }
Vector3d to_program(const Vector3d& v) { return {v.x(), v.z(), -v.y()}; }

/// (1.3.12), (1.3.13) and gravity at the state's position.
SplitState with_slow_quantities(const earth::Earth& earth, SplitState s) {
    const earth::EarthTerms t = earth::terms_at(earth, s.position, to_program(s.v_nhe));
    s.w_rel = to_paper(t.w_en_n);
    s.w_earth = to_paper(t.w_ie_n);
    s.g_nhe = to_paper(t.g_n);
    s.w_level_b = matrix_from(s.angles).transpose() * (s.w_rel + s.w_earth);
    s.v_slow = s.v_nhe;
    s.since_slow = 0.0;
    s.medium_steps = 0;
    return s;
}

}  // namespace

SplitState split_from(const earth::Earth& earth, const NavState& state) {
    SplitState s;
    s.time = state.time;
    s.position = state.position;
    s.v_nhe = to_paper(state.v_eb_n);
    const Matrix3d B = earth::dcm_in(earth::paper_a_chapter1_axes, state.q_nb.toRotationMatrix());
    const earth::PaperAngles a = earth::paper_a_chapter1_angles(B);
    s.angles = {a.azimuth, a.pitch, a.roll};
    s.B_medium = B;
    return with_slow_quantities(earth, s);
}

NavState nav_state_of(const SplitState& state) {
    NavState s;
    s.time = state.time;
    s.position = state.position;
    s.v_eb_n = to_program(state.v_nhe);
    s.q_nb = Eigen::Quaterniond(earth::C_nb_from(earth::paper_a_chapter1_axes, matrix_from(state.angles)));
    return s;
}

SplitState fast_step(const SplitState& state, const ImuIncrement& increment) {
    SplitState s = state;
    const Vector3d w = to_paper(increment.dtheta) / increment.dt - s.w_level_b;
    s.angles = step_angles(s.angles, w, increment.dt);
    s.dv_b += to_paper(increment.dv);
    s.time = increment.time;
    s.since_medium += increment.dt;
    ++s.fast_steps;
    return s;
}

SplitState medium_step(const SplitState& state) {
    SplitState s = state;
    const Matrix3d B = matrix_from(s.angles);
    const Vector3d dv = 0.5 * (s.B_medium + B) * s.dv_b;
    s.v_nhe += dv + s.since_medium * (s.g_nhe - (s.w_rel + 2.0 * s.w_earth).cross(s.v_nhe + 0.5 * dv));
    s.B_medium = B;
    s.dv_b.setZero();
    s.since_slow += s.since_medium;
    s.since_medium = 0.0;
    s.fast_steps = 0;
    ++s.medium_steps;
    return s;
}

SplitState slow_step(const earth::Earth& earth, const SplitState& state) {
    SplitState s = state;
    const Vector3d moved = 0.5 * s.since_slow * (s.v_slow + s.v_nhe);
    s.position = earth::moved_by_ned(earth, s.position, to_program(moved));
    return with_slow_quantities(earth, s);
}

SplitState split_step(const earth::Earth& earth, const SplitState& state, const ImuIncrement& increment, const RateSplit& split) {
    SplitState s = fast_step(state, increment);
    if (s.fast_steps < split.fast_per_medium) return s;
    s = medium_step(s);
    if (s.medium_steps < split.medium_per_slow) return s;
    return slow_step(earth, s);
}

}  // namespace schuler::ins::paper_a
