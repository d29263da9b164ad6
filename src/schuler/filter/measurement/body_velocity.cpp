#include "schuler/filter/measurement/body_velocity.h"

#include "schuler/math/rotation.h"

#include <Eigen/Geometry>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

Measurement body_velocity(const Estimate& e, const Vector3d& measured_b, double variance, const Vector3d& lever_arm_b) {
    const Layout& L = e.layout;
    const Matrix3d C_bn = e.C_nb.transpose();
    const Vector3d w_ie_n = earth::terms_at(e.earth, e.nav.position, e.nav.v_eb_n).w_ie_n;
    const Vector3d v_b = C_bn * e.nav.v_eb_n + (e.w_ib_b - C_bn * w_ie_n).cross(lever_arm_b);
    const double gain = 1.0 + (L.log_scale >= 0 ? e.parameters(L.log_scale) : 0.0);
    Vector3d turned = Vector3d::Zero();
    if (L.log_misalignment >= 0) turned.tail<2>() = e.parameters.segment<2>(L.log_misalignment);
    const Matrix3d errors = gain * (Matrix3d::Identity() + skew(turned));
    const Matrix3d by_velocity = errors * C_bn;
    const Matrix3d by_attitude = -errors * (C_bn * skew(e.nav.v_eb_n) + skew(lever_arm_b) * C_bn * skew(w_ie_n));
    const Matrix3d by_gyro_bias = errors * skew(lever_arm_b);
    const Vector3d by_scale = errors * v_b / gain, difference = errors * v_b - measured_b;
    const Matrix3d by_misalignment = -gain * skew(v_b);
    Measurement m;
    for (int axis = 0; axis < 3; ++axis) {
        estim::Row& row = m.add(difference(axis), variance);
        velocity_of(row) = by_velocity.row(axis).transpose();
        attitude_of(row) = by_attitude.row(axis).transpose();
        row.add3(Layout::gyro_bias, by_gyro_bias.row(axis).transpose());
        if (L.log_scale >= 0) row.add(L.log_scale, by_scale(axis));
        for (int i = 0; L.log_misalignment >= 0 && i < 2; ++i) row.add(L.log_misalignment + i, by_misalignment(axis, 1 + i));
    }
    return m;
}

Measurement measurement_of(const Estimate& e, const BodyVelocitySample& s, const Settings& settings) {
    return body_velocity(e, s.velocity_b, settings.log.std * settings.log.std, settings.log.lever_arm_b);
}

}  // namespace schuler::filter
