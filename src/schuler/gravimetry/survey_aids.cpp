#include "schuler/gravimetry/survey_aids.h"

#include "schuler/ins/error_model.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"

#include <Eigen/Geometry>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::RowVector3d;
using Eigen::Vector3d;
using math::skew;

namespace {

Vector3d up_e(const earth::Earth& earth, const SurveyState& state) {
    const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, state.nav.position);
    return -earth::C_en(place.lat, place.lon).col(2);
}

/// What the log would show: the body's velocity at it, and what its errors make of that.
struct LogVelocity {
    Matrix3d C_be;
    Vector3d w_ie_e, v_b;   ///< v_b: of the point, without the log's errors
    Matrix3d errors;        ///< (1 + scale) (I + [misalignment x])
};

LogVelocity log_velocity(const earth::Earth& earth, const SurveyState& state, const Vector3d& lever_arm_b,
                         const Vector3d& w_ib_b) {
    LogVelocity out;
    out.C_be = state.nav.q_eb.toRotationMatrix().transpose();
    out.w_ie_e = {0.0, 0.0, earth.ellipsoid.w_ie};
    out.v_b = out.C_be * state.nav.v_eb_e + (w_ib_b - out.C_be * out.w_ie_e).cross(lever_arm_b);
    const Vector3d turned(0.0, state.parameters(log_misalignment), state.parameters(log_misalignment + 1));
    out.errors = (1.0 + state.parameters(log_scale)) * (Matrix3d::Identity() + skew(turned));
    return out;
}

}  // namespace

double height_innovation(const earth::Earth& earth, const SurveyState& state, const Vector3d& lever_arm_b, const HeightFix& fix) {
    const double h = earth::geodetic_from_ecef(earth.ellipsoid, state.nav.position).h;
    return h + up_e(earth, state).dot(state.nav.q_eb * lever_arm_b) + state.parameters(height_bias + fix.gauge) - fix.height;
}

StateVector gravity_height_row(const earth::Earth& earth, const SurveyState& state, const Vector3d& lever_arm_b, int gauge) {
    const Vector3d up = up_e(earth, state), lever_arm_e = state.nav.q_eb * lever_arm_b;
    const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, state.nav.position);
    const Matrix3d C_en = earth::C_en(place.lat, place.lon);
    const Matrix3d turn =
        C_en * ins::level_rotation_by_displacement(earth::terms_at(earth, place, Vector3d::Zero())) * C_en.transpose();
    StateVector h = StateVector::Zero();
    h.segment<3>(position) = up + turn.transpose() * up.cross(lever_arm_e);
    h.segment<3>(attitude) = skew(lever_arm_e).transpose() * up;
    h(height_bias + gauge) = 1.0;
    return h;
}

Vector3d body_velocity_innovation(const earth::Earth& earth, const SurveyState& state, const Vector3d& lever_arm_b,
                                  const Vector3d& w_ib_b, const BodyVelocityFix& fix) {
    const LogVelocity log = log_velocity(earth, state, lever_arm_b, w_ib_b);
    return log.errors * log.v_b - fix.velocity_b;
}

BodyVelocityRows gravity_body_velocity_rows(const earth::Earth& earth, const SurveyState& state, const Vector3d& lever_arm_b,
                                            const Vector3d& w_ib_b) {
    const LogVelocity log = log_velocity(earth, state, lever_arm_b, w_ib_b);
    const double scale = 1.0 + state.parameters(log_scale);
    BodyVelocityRows H = BodyVelocityRows::Zero();
    H.middleCols<3>(velocity) = log.errors * log.C_be;
    H.middleCols<3>(attitude) =
        -log.errors * (log.C_be * skew(state.nav.v_eb_e) + skew(lever_arm_b) * log.C_be * skew(log.w_ie_e));
    H.middleCols<3>(gyro_bias) = log.errors * skew(lever_arm_b);
    H.col(log_scale) = log.errors * log.v_b / scale;
    H.middleCols<2>(log_misalignment) = -scale * skew(log.v_b).rightCols<2>();
    return H;
}

double heading_innovation(const earth::Earth& earth, const SurveyState& state, const HeadingFix& fix) {
    const double heading = math::rpy_from_quaternion(ins::to_geographic(earth, state.nav).q_nb).z();
    return math::wrap_pi(heading + state.parameters(heading_bias) - fix.heading);
}

StateVector gravity_heading_row(const earth::Earth& earth, const SurveyState& state) {
    const NavState nav = ins::to_geographic(earth, state.nav);
    const RowVector3d by_phi = math::rpy_error_from_phi(math::rpy_from_quaternion(nav.q_nb)).row(2);
    const Eigen::Matrix<double, 9, 9> M = ins::geographic_from_ecef_errors(earth, nav);
    StateVector h = StateVector::Zero();
    h.segment<3>(position) = (by_phi * M.block<3, 3>(6, 0)).transpose();
    h.segment<3>(attitude) = (by_phi * M.block<3, 3>(6, 6)).transpose();
    h(heading_bias) = 1.0;
    return h;
}

}  // namespace schuler::gravimetry
