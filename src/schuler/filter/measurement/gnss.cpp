#include "schuler/filter/measurement/gnss.h"

#include "schuler/filter/states/heading_force.h"
#include "schuler/math/rotation.h"

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

namespace {

Vector3d lever_arm(const Estimate& e, const Vector3d& given) {
    return e.layout.lever_arm < 0 ? given : Vector3d(e.parameters.segment<3>(e.layout.lever_arm));
}

/// s: the fix gives the antenna as it was so long before. `state`: -1 if it is none.
double latency(const Estimate& e, int state) { return state < 0 ? 0.0 : e.parameters(state); }

}  // namespace

Measurement gnss_position(const Estimate& e, const Geodetic& measured, const Vector3d& variance, const Vector3d& lever_arm_b,
                          Components use) {
    const Vector3d l_b = lever_arm(e, lever_arm_b);
    const Vector3d difference = earth::ned_difference(e.earth, e.nav.position, measured);
    const int state = e.layout.gnss_latency;
    const double late = latency(e, state);
    const Vector3d w_eb_b = state >= 0 ? rate_to_earth(e) : Vector3d(Vector3d::Zero());
    const Vector3d s_n = e.C_nb * w_eb_b.cross(l_b), l_n = e.C_nb * l_b - late * s_n;
    const Vector3d v_n = e.nav.v_eb_n + s_n;
    const Matrix3d by_attitude = skew(l_n), by_gyro_bias = -late * e.C_nb * skew(l_b);
    const Matrix3d by_lever_arm = e.C_nb - late * e.C_nb * skew(for_lever_arm(w_eb_b, e.uncertain_rate));
    Measurement m;
    for (int axis = 0; axis < 3; ++axis) {
        if (!use[axis]) continue;
        const double of_rate = e.rate_variance * by_gyro_bias.row(axis).squaredNorm();
        estim::Row& row = m.add(difference(axis) + l_n(axis), variance(axis) + of_rate);
        position_of(row)(axis) = 1.0;
        attitude_of(row) = by_attitude.row(axis).transpose();
        if (e.layout.lever_arm >= 0) row.add3(e.layout.lever_arm, by_lever_arm.row(axis).transpose());
        if (state >= 0) {
            m.innovation(m.dof - 1) += late * (0.5 * late * e.a_n(axis) - e.nav.v_eb_n(axis));
            velocity_of(row)(axis) = -late;
            row.add3(Layout::gyro_bias, by_gyro_bias.row(axis).transpose());
            row.add(state, late * e.a_n(axis) - v_n(axis));
        }
        if (e.layout.gnss_position >= 0) {
            m.innovation(m.dof - 1) += e.parameters(e.layout.gnss_position + axis);
            row.add(e.layout.gnss_position + axis, 1.0);
        }
    }
    return m;
}

Measurement gnss_velocity(const Estimate& e, const Vector3d& measured, const Vector3d& variance, const Vector3d& lever_arm_b,
                          int latency_state, Components use) {
    const Vector3d l_b = lever_arm(e, lever_arm_b);
    const Vector3d w_eb_b = rate_to_earth(e);
    const double late = latency(e, latency_state);
    // The antenna turns about the unit: in a vibration, most of its acceleration.
    const Vector3d turned = w_eb_b.cross(l_b), turning = e.angular_acceleration.cross(l_b) + w_eb_b.cross(turned);
    const Vector3d a_n = e.a_n + e.C_nb * turning, s_n = e.C_nb * (turned - late * turning);
    const Vector3d difference = e.nav.v_eb_n - late * e.a_n + s_n - measured;
    Matrix3d by_attitude = skew(s_n);
    by_attitude.col(2) =
        for_heading(s_n, Vector3d::UnitZ(), e.heading_unknown * e.uncertain_rate * l_b.norm()).cross(Vector3d::UnitZ());
    const Matrix3d by_gyro_bias = e.C_nb * (skew(l_b) - late * (skew(turned) + skew(w_eb_b) * skew(l_b)));
    const Vector3d rate = for_lever_arm(w_eb_b - late * e.angular_acceleration, e.uncertain_rate);
    const Matrix3d by_lever_arm = e.C_nb * (skew(rate) - late * skew(rate) * skew(rate));
    Measurement m;
    for (int axis = 0; axis < 3; ++axis) {
        if (!use[axis]) continue;
        // the rate at which the lever arm turns has the noise of the gyros
        const double of_rate = e.rate_variance * by_gyro_bias.row(axis).squaredNorm();
        estim::Row& row = m.add(difference(axis), variance(axis) + of_rate);
        velocity_of(row)(axis) = 1.0;
        attitude_of(row) = by_attitude.row(axis).transpose();
        row.add3(Layout::gyro_bias, by_gyro_bias.row(axis).transpose());
        if (e.layout.lever_arm >= 0) row.add3(e.layout.lever_arm, by_lever_arm.row(axis).transpose());
        if (latency_state >= 0) row.add(latency_state, -a_n(axis));
        if (e.layout.gnss_velocity >= 0) {
            m.innovation(m.dof - 1) += e.parameters(e.layout.gnss_velocity + axis);
            row.add(e.layout.gnss_velocity + axis, 1.0);
        }
    }
    return m;
}

}  // namespace schuler::filter
