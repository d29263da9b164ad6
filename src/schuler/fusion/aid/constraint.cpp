#include "schuler/fusion/aid/constraint.h"

#include "schuler/math/rotation.h"

namespace schuler::fusion {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

LocalMeasurement zero_velocity(const Estimate& e, double std) {
    LocalMeasurement m;
    for (int axis = 0; axis < 3; ++axis) {
        const int i = add_component(m, e.nav.v_eb_n(axis), std * std);
        m.rows(Layout::velocity + axis, i) = 1.0;
    }
    return m;
}

LocalMeasurement zero_rate(const Estimate& e, const Vector3d& mean_raw_rate_b, double variance) {
    const Vector3d w_ie_n = earth::terms_at(e.earth, e.nav.position, e.nav.v_eb_n).w_ie_n;
    const Vector3d expected = e.parameters.segment<3>(Layout::gyro_bias) + e.C_nb.transpose() * w_ie_n;
    // C_nb_est^T = C_nb^T (I + [phi x]), so the expected rate changes by C_nb^T (phi x w_ie) = -C_nb^T [w_ie x] phi.
    const Matrix3d by_attitude = -e.C_nb.transpose() * skew(w_ie_n);
    LocalMeasurement m;
    for (int axis = 0; axis < 3; ++axis) {
        const int i = add_component(m, expected(axis) - mean_raw_rate_b(axis), variance);
        m.rows(Layout::gyro_bias + axis, i) = 1.0;
        m.rows.col(i).segment<3>(Layout::attitude) = by_attitude.row(axis).transpose();
    }
    return m;
}

Matrix3d body_from_vehicle(double pitch, double yaw) { return math::dcm_from_rpy({0.0, pitch, yaw}); }

LocalMeasurement nonholonomic(const Estimate& e, double std_lateral, double std_vertical) {
    const double pitch = e.parameters(e.layout.mounting), yaw = e.parameters(e.layout.mounting + 1);
    const Matrix3d C_vb = body_from_vehicle(pitch, yaw).transpose();
    const Vector3d w_ie_n = earth::terms_at(e.earth, e.nav.position, e.nav.v_eb_n).w_ie_n;
    const Vector3d w_eb_b = e.w_ib_b - e.C_nb.transpose() * w_ie_n;
    const Vector3d arm(e.parameters(e.layout.axle), 0.0, 0.0);
    const Vector3d v_b = e.C_nb.transpose() * e.nav.v_eb_n - w_eb_b.cross(arm);
    const Vector3d v_v = C_vb * v_b;
    const Matrix3d by_velocity = C_vb * e.C_nb.transpose();
    const Matrix3d by_attitude = -by_velocity * skew(e.nav.v_eb_n);
    const Matrix3d by_gyro_bias = -C_vb * skew(arm);
    const Vector3d by_pitch = -Vector3d::UnitY().cross(v_v);
    const Vector3d by_yaw = -C_vb * Vector3d::UnitZ().cross(v_b);
    const Vector3d by_axle = -C_vb * w_eb_b.cross(Vector3d::UnitX());
    const Vector3d std(0.0, std_lateral, std_vertical);
    LocalMeasurement m;
    for (const int axis : {1, 2}) {
        const int i = add_component(m, v_v(axis), std(axis) * std(axis));
        m.rows.col(i).segment<3>(Layout::velocity) = by_velocity.row(axis).transpose();
        m.rows.col(i).segment<3>(Layout::attitude) = by_attitude.row(axis).transpose();
        m.rows.col(i).segment<3>(Layout::gyro_bias) = by_gyro_bias.row(axis).transpose();
        m.rows(e.layout.mounting, i) = by_pitch(axis);
        m.rows(e.layout.mounting + 1, i) = by_yaw(axis);
        m.rows(e.layout.axle, i) = by_axle(axis);
    }
    return m;
}

}  // namespace schuler::fusion
