#include "schuler/fusion/outputs.h"

#include "schuler/math/rotation.h"

namespace schuler::fusion {

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
    const Matrix3d J = math::rpy_error_from_phi(row.rpy);
    const Matrix3d P_rpy = J * P_n.block<3, 3>(Layout::attitude, Layout::attitude) * J.transpose();
    row.std_rpy = P_rpy.diagonal().cwiseMax(0.0).cwiseSqrt();
    return row;
}

template <int N>
SensorErrorRow sensor_error_row(Time time, const Layout& layout, const Eigen::Matrix<double, N, 1>& parameters,
                                const Eigen::Matrix<double, N, 1>& variances) {
    const Eigen::Matrix<double, N, 1> std = variances.cwiseMax(0.0).cwiseSqrt();
    const auto value = [&](int offset) -> Vector3d {
        return offset < 0 ? Vector3d(Vector3d::Zero()) : Vector3d(parameters.template segment<3>(offset));
    };
    const auto sigma = [&](int offset) -> Vector3d {
        return offset < 0 ? Vector3d(Vector3d::Zero()) : Vector3d(std.template segment<3>(offset));
    };
    return {time,
            value(Layout::gyro_bias), sigma(Layout::gyro_bias),
            value(Layout::accel_bias), sigma(Layout::accel_bias),
            value(layout.gyro_scale), sigma(layout.gyro_scale),
            value(layout.accel_scale), sigma(layout.accel_scale)};
}

template <int N>
StateRow state_row(const Layout& layout, const NavState& nav, const Eigen::Matrix<double, N, 1>& parameters,
                   const Eigen::Matrix<double, N, N>& P, const Matrix9& P_n) {
    const auto block = [&](int offset, int dof) {
        StateBlock b;
        if (offset < 0) return b;
        b.dof = dof;
        b.value.head(dof) = parameters.segment(offset, dof);
        b.covariance.topLeftCorner(dof, dof) = P.block(offset, offset, dof, dof);
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
    return row;
}

#define SCHULER_INSTANTIATE(N)                                                                        \
    template StateRow state_row<N>(const Layout&, const NavState&, const Eigen::Matrix<double, N, 1>&, \
                                   const Eigen::Matrix<double, N, N>&, const Matrix9&);
SCHULER_INSTANTIATE(16)
SCHULER_INSTANTIATE(24)
SCHULER_INSTANTIATE(44)
#undef SCHULER_INSTANTIATE

template SensorErrorRow sensor_error_row<16>(Time, const Layout&, const Eigen::Matrix<double, 16, 1>&,
                                             const Eigen::Matrix<double, 16, 1>&);
template SensorErrorRow sensor_error_row<24>(Time, const Layout&, const Eigen::Matrix<double, 24, 1>&,
                                             const Eigen::Matrix<double, 24, 1>&);
template SensorErrorRow sensor_error_row<44>(Time, const Layout&, const Eigen::Matrix<double, 44, 1>&,
                                             const Eigen::Matrix<double, 44, 1>&);

}  // namespace schuler::fusion
