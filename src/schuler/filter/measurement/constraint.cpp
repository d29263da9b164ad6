#include "schuler/filter/measurement/constraint.h"

#include "schuler/math/rotation.h"

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

Measurement zero_velocity(const Estimate& e, double std) {
    Measurement m;
    for (int axis = 0; axis < 3; ++axis) {
        estim::Row& row = m.add(e.nav.v_eb_n(axis), std * std);
        velocity_of(row)(axis) = 1.0;
    }
    return m;
}

Measurement zero_rate(const Estimate& e, const Vector3d& mean_raw_rate_b, double variance) {
    const Vector3d w_ie_n = earth::terms_at(e.earth, e.nav.position, e.nav.v_eb_n).w_ie_n;
    const Vector3d expected = e.parameters.segment<3>(Layout::gyro_bias) + e.C_nb.transpose() * w_ie_n;
    // C_nb_est^T = C_nb^T (I + [phi x]), so the expected rate changes by C_nb^T (phi x w_ie) = -C_nb^T [w_ie x] phi.
    const Matrix3d by_attitude = -e.C_nb.transpose() * skew(w_ie_n);
    Measurement m;
    for (int axis = 0; axis < 3; ++axis) {
        estim::Row& row = m.add(expected(axis) - mean_raw_rate_b(axis), variance);
        row.add(Layout::gyro_bias + axis, 1.0);
        attitude_of(row) = by_attitude.row(axis).transpose();
    }
    return m;
}

Matrix3d body_from_vehicle(double pitch, double yaw) { return math::dcm_from_rpy({0.0, pitch, yaw}); }

Measurement nonholonomic(const Estimate& e, double std_lateral, double std_vertical) {
    const double pitch = e.parameters(e.layout.mounting), yaw = e.parameters(e.layout.mounting + 1);
    const Matrix3d C_vb = body_from_vehicle(pitch, yaw).transpose();
    const Vector3d w_eb_b = rate_to_earth(e);
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
    Measurement m;
    for (const int axis : {1, 2}) {
        estim::Row& row = m.add(v_v(axis), std(axis) * std(axis));
        velocity_of(row) = by_velocity.row(axis).transpose();
        attitude_of(row) = by_attitude.row(axis).transpose();
        row.add3(Layout::gyro_bias, by_gyro_bias.row(axis).transpose());
        row.add(e.layout.mounting, by_pitch(axis));
        row.add(e.layout.mounting + 1, by_yaw(axis));
        row.add(e.layout.axle, by_axle(axis));
    }
    return m;
}

}  // namespace schuler::filter
