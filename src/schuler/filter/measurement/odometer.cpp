#include "schuler/filter/measurement/odometer.h"

#include "schuler/core/units.h"
#include "schuler/filter/measurement/constraint.h"
#include "schuler/math/rotation.h"

#include <cmath>
#include <numbers>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

Measurement odometer_speed(const Estimate& e, double measured, double variance) {
    const Layout& L = e.layout;
    const bool mounted = L.mounting >= 0;
    const Matrix3d C_vb = mounted
                              ? Matrix3d(body_from_vehicle(e.parameters(L.mounting), e.parameters(L.mounting + 1)).transpose())
                              : Matrix3d(Matrix3d::Identity());
    const Vector3d arm(L.axle >= 0 ? e.parameters(L.axle) : 0.0, 0.0, 0.0);
    const double gain = 1.0 + (L.odometer_scale >= 0 ? e.parameters(L.odometer_scale) : 0.0);
    const Vector3d w_eb_b = rate_to_earth(e);
    const Vector3d v_b = e.C_nb.transpose() * e.nav.v_eb_n - w_eb_b.cross(arm);
    const double speed = C_vb.row(0).dot(v_b);
    Measurement m;
    estim::Row& row = m.add(gain * speed - measured, variance);
    const Eigen::RowVector3d by_velocity = gain * C_vb.row(0) * e.C_nb.transpose();
    velocity_of(row) = by_velocity.transpose();
    attitude_of(row) = (-by_velocity * skew(e.nav.v_eb_n)).transpose();
    row.add3(Layout::gyro_bias, (-gain * C_vb.row(0) * skew(arm)).transpose());
    if (mounted) {
        row.add(L.mounting, -gain * Vector3d::UnitY().cross(C_vb * v_b).x());
        row.add(L.mounting + 1, -gain * C_vb.row(0).dot(Vector3d::UnitZ().cross(v_b)));
    }
    if (L.axle >= 0) row.add(L.axle, -gain * C_vb.row(0).dot(w_eb_b.cross(Vector3d::UnitX())));
    if (L.odometer_scale >= 0) row.add(L.odometer_scale, speed);
    return m;
}

Measurement heading_of_body(const Estimate& e, double measured, double variance) {
    Measurement m;
    const Vector3d rpy = math::rpy_from_quaternion(e.nav.q_nb);
    if (std::abs(rpy.y()) > 0.5 * std::numbers::pi - units::deg) return m;
    const bool with_offset = e.layout.heading_offset >= 0;
    const double offset = with_offset ? e.parameters(e.layout.heading_offset) : 0.0;
    estim::Row& row = m.add(math::wrap_pi(rpy.z() + offset - measured), variance);
    attitude_of(row) = math::rpy_error_from_phi(rpy).row(2).transpose();
    if (with_offset) row.add(e.layout.heading_offset, 1.0);
    return m;
}

Measurement measurement_of(const Estimate& e, const OdometerSample& s, const Settings& settings) {
    const double std = s.std > 0.0 ? s.std : settings.odometer.std;
    return odometer_speed(e, s.speed, std * std);
}

Measurement measurement_of(const Estimate& e, const HeadingSample& s, const Settings& settings) {
    const double std = s.std > 0.0 ? s.std : settings.heading.std;
    return heading_of_body(e, s.heading, std * std);
}

}  // namespace schuler::filter
