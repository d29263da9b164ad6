#include "schuler/filter/outputs.h"

#include "schuler/math/rotation.h"
#include "schuler/math/steep_attitude.h"

#include <algorithm>
#include <cmath>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;

SolutionRow solution_row(const NavState& nav, const Matrix9& P_n) {
    SolutionRow row;
    row.time = nav.time;
    row.position = nav.position;
    row.v_eb_n = nav.v_eb_n;
    row.rpy = math::rpy_from_quaternion(nav.q_nb);
    row.std_position = P_n.diagonal().segment<3>(Layout::position).cwiseMax(0.0).cwiseSqrt();
    row.std_velocity = P_n.diagonal().segment<3>(Layout::velocity).cwiseMax(0.0).cwiseSqrt();
    const Matrix3d J = math::attitude_error_from_phi(row.rpy);
    const Matrix3d P_rpy = J * P_n.block<3, 3>(Layout::attitude, Layout::attitude) * J.transpose();
    row.std_rpy = P_rpy.diagonal().cwiseMax(0.0).cwiseSqrt();
    return row;
}

namespace {

/// A point of the body, and the effect of an error of the unit's motion, and of the rate, on its own.
struct PointMotion {
    NavState nav;
    Matrix9 by_unit = Matrix9::Identity();
    Matrix3d by_rate;  // of the velocity, by an error of the rate that is subtracted (gyro bias)
};

PointMotion motion_of(const Estimate& e, const Vector3d& l_b) {
    const Vector3d l_n = e.C_nb * l_b, s_n = e.C_nb * rate_to_earth(e).cross(l_b);
    PointMotion m;
    m.nav = e.nav;
    m.nav.position = earth::moved_by_ned(e.earth, e.nav.position, l_n);
    m.nav.v_eb_n += s_n;
    m.by_unit.block<3, 3>(Layout::position, Layout::attitude) = math::skew(l_n);
    m.by_unit.block<3, 3>(Layout::velocity, Layout::attitude) = math::skew(s_n);
    m.by_rate = e.C_nb * math::skew(l_b);
    return m;
}

/// That of the antenna; the covariance of all states is at the time of the nominal state.
template <class Frame>
Reported antenna(const InertialModel& model, const InertialFilter<Frame>& f, const Matrix9& undecided) {
    const Estimate e = f.estimate(model);
    const PointMotion m = motion_of(e, f.lever_arm(model));
    Eigen::Matrix<double, 9, Eigen::Dynamic, 0, 9, estim::max_states> J(9, f.P.cols());
    J.setZero();
    J.template leftCols<9>() = m.by_unit * f.to_local_level(model);
    J.template block<3, 3>(Layout::velocity, Layout::gyro_bias) = m.by_rate;
    if (const int own = model.layout.lever_arm; own >= 0) {
        J.template block<3, 3>(Layout::position, own) = e.C_nb;
        J.template block<3, 3>(Layout::velocity, own) = e.C_nb * math::skew(rate_to_earth(e));
    }
    // what is not in the states refers to the unit
    const Matrix9 besides = reported_covariance(model, f, undecided) - f.local_covariance(model);
    Matrix9 P = J * estim::as_double(f.P) * J.transpose() + m.by_unit * besides * m.by_unit.transpose();
    P.block<3, 3>(Layout::velocity, Layout::velocity) += e.rate_variance * m.by_rate * m.by_rate.transpose();
    return {m.nav, P};
}

}  // namespace

template <class Frame>
Reported reported(const InertialModel& model, const InertialFilter<Frame>& f, const Matrix9& undecided) {
    if (!model.at_antenna) return {f.geographic(model), reported_covariance(model, f, undecided)};
    if (!(f.gathered.time > 0.0)) return antenna(model, f, undecided);
    InertialFilter<Frame> now = f;
    estim::Transition phi;
    (void)now.propagate_covariance(model, phi);
    return antenna(model, now, undecided);
}
template Reported reported(const InertialModel&, const InertialFilter<GeographicFrame>&, const Matrix9&);
template Reported reported(const InertialModel&, const InertialFilter<EarthFixedFrame>&, const Matrix9&);

SolutionRow solution_row_at(const Estimate& e, const Matrix9& P_n, const Vector3d& lever_arm_b, const Vector3d& rate_variance) {
    const PointMotion m = motion_of(e, lever_arm_b);
    Matrix9 P = m.by_unit * P_n * m.by_unit.transpose();
    P.block<3, 3>(Layout::velocity, Layout::velocity) += m.by_rate * rate_variance.asDiagonal() * m.by_rate.transpose();
    return solution_row(m.nav, P);
}

SensorErrorRow sensor_error_row(Time time, const Layout& layout, const StateVector& parameters, const StateVector& variances) {
    const StateVector std = variances.cwiseMax(0.0).cwiseSqrt();
    const auto value = [&](int offset) -> Vector3d {
        return offset < 0 ? Vector3d(Vector3d::Zero()) : Vector3d(parameters.segment<3>(offset));
    };
    const auto sigma = [&](int offset) -> Vector3d {
        return offset < 0 ? Vector3d(Vector3d::Zero()) : Vector3d(std.segment<3>(offset));
    };
    return {time,
            value(Layout::gyro_bias),
            sigma(Layout::gyro_bias),
            value(Layout::accel_bias),
            sigma(Layout::accel_bias),
            value(layout.gyro_scale),
            sigma(layout.gyro_scale),
            value(layout.accel_scale),
            sigma(layout.accel_scale)};
}

StateRow state_row(const Layout& layout, const NavState& nav, const StateVector& parameters, const StateMatrix& P,
                   const Matrix9& P_n) {
    const auto block = [&](int offset, int dof) {
        StateBlock b;
        if (offset < 0) return b;
        b.dof = dof;
        b.value.head(dof) = parameters.segment(offset, dof);
        b.covariance.topLeftCorner(dof, dof) = estim::as_double(P.block(offset, offset, dof, dof));
        return b;
    };
    StateRow row;
    row.time = nav.time;
    row.nav = nav;
    row.P_position = P_n.block<3, 3>(Layout::position, Layout::position);
    row.P_velocity = P_n.block<3, 3>(Layout::velocity, Layout::velocity);
    row.P_attitude = P_n.block<3, 3>(Layout::attitude, Layout::attitude);
    row.P_navigation = P_n;
    row.gyro_bias = block(Layout::gyro_bias, 3);
    row.accel_bias = block(Layout::accel_bias, 3);
    row.gnss_position = block(layout.gnss_position, 3);
    row.gnss_velocity = block(layout.gnss_velocity, 3);
    row.baro_bias = block(layout.baro_bias, 1);
    row.clock = block(layout.clock, 2);
    return row;
}

ParameterRow parameter_row(Time time, const Layout& layout, const StateVector& parameters, const StateMatrix& P) {
    ParameterRow row;
    row.time = time;
    const auto is_slot = [&](int i) {  // assigned to sources and carriers as they come
        return (layout.source >= 0 && i >= layout.source) ||
               (layout.source_rate >= 0 && i >= layout.source_rate && i < layout.source_rate + Layout::slots) ||
               (layout.ambiguity >= 0 && i >= layout.ambiguity && i < layout.ambiguity + layout.ambiguities) ||
               (layout.phase >= 0 && i >= layout.phase && i < layout.phase + 2 * layout.phases);
    };
    for (int i = Layout::navigation; i < layout.size; ++i) {
        const bool free = is_slot(i) && !(P(i, i) > 0.0);
        row.value.push_back(free ? not_given : parameters(i));
        row.std.push_back(free ? not_given : std::sqrt(std::max(0.0, double{P(i, i)})));
    }
    return row;
}

CovarianceRow covariance_row(Time time, const Layout& layout, const StateMatrix& P) {
    CovarianceRow row;
    row.time = time;
    row.covariance.reserve(static_cast<std::size_t>(layout.size * layout.size));
    for (int c = 0; c < layout.size; ++c)
        row.covariance.insert(row.covariance.end(), P.col(c).data(), P.col(c).data() + layout.size);
    return row;
}

}  // namespace schuler::filter
