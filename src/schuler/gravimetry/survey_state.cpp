#include "schuler/gravimetry/survey_state.h"

#include "schuler/ins/state_error.h"
#include "schuler/ins/step.h"

#include <Eigen/Geometry>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;

ImuIncrement without_sensor_errors(const SurveyState& state, const ImuIncrement& raw) {
    ImuIncrement out = raw;
    out.dtheta -= raw.dt * state.parameters.segment<3>(gyro_bias);
    out.dv -= raw.dt * state.parameters.segment<3>(accel_bias);
    return out;
}

SurveyState advanced(const earth::Earth& earth, const DisturbanceModel& disturbance, const SurveyState& state,
                     const ins::CompensatedIncrement& increment) {
    // The disturbance acts like a specific force; over a step its change (below 1e-9 m/s^2) and the Earth's turn do not count.
    ins::CompensatedIncrement felt = increment;
    const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, state.nav.position);
    const Matrix3d to_earth_fixed = disturbance.to_earth_fixed(earth::C_en(place.lat, place.lon));
    felt.dv += increment.dt * (state.nav.q_eb.conjugate() * Vector3d(to_earth_fixed * state.disturbance()));
    SurveyState next = state;
    next.nav = ins::step_e(earth, state.nav, felt);
    if (disturbance.kind == DisturbanceKind::Constant) return next;

    const double distance = disturbance.pace(0.5 * (state.nav.v_eb_e + next.nav.v_eb_e)) * increment.dt;
    const Matrix3d X = distance * random_part_dynamics(disturbance);
    const Matrix3d growth = Matrix3d::Identity() + X * (Matrix3d::Identity() + X * (0.5 * Matrix3d::Identity() + X / 6.0));
    const Eigen::Map<const Matrix3d> before(state.parameters.data() + random);   // columns: value, slope, curvature
    Eigen::Map<Matrix3d> after(next.parameters.data() + random);
    after = before * growth.transpose();
    if (disturbance.degree() > 0) {   // no part of the process: Taylor's series of the systematic part
        const Vector3d bend = disturbance.degree() > 1 ? Vector3d(distance * before.col(2)) : Vector3d(Vector3d::Zero());
        after.col(1) = before.col(1) + bend;
        next.parameters.segment<3>(systematic) += distance * (before.col(1) + 0.5 * bend);
    }
    return next;
}

Eigen::Matrix<double, 6, 1> gnss_innovation(const earth::Earth& earth, const SurveyState& state, const Vector3d& lever_arm_b,
                                            const Vector3d& w_ib_b, const AntennaFix& fix) {
    const Matrix3d C_eb = state.nav.q_eb.toRotationMatrix();
    const Vector3d w_eb_b = w_ib_b - C_eb.transpose() * Vector3d(0.0, 0.0, earth.ellipsoid.w_ie);
    Eigen::Matrix<double, 6, 1> z;
    z << state.nav.position.r + C_eb * lever_arm_b + state.parameters.segment<3>(gnss_position) - fix.position,
        state.nav.v_eb_e + C_eb * w_eb_b.cross(lever_arm_b) + state.parameters.segment<3>(gnss_velocity) - fix.velocity;
    return z;
}

SurveyState corrected(const SurveyState& estimate, const StateVector& dx) {
    SurveyState out{ins::corrected(estimate.nav, dx.head<9>()), estimate.parameters};
    out.parameters.tail<max_states - accel_bias>() -= dx.tail<max_states - accel_bias>();
    return out;
}

SurveyState perturbed(const SurveyState& truth, const StateVector& dx) {
    SurveyState out{ins::perturbed(truth.nav, dx.head<9>()), truth.parameters};
    out.parameters.tail<max_states - accel_bias>() += dx.tail<max_states - accel_bias>();
    return out;
}

}  // namespace schuler::gravimetry
