// From a filter's state and covariance to the rows that are reported.
#pragma once

#include "schuler/fusion/inertial_filter.h"
#include "schuler/fusion/result.h"

namespace schuler::fusion {

/// Solution row from a geographic state and its 9 x 9 local-level error covariance.
[[nodiscard]] SolutionRow solution_row(const NavState& nav, const Matrix9& P_n);

/// Sensor errors from the nominal parameters and the variances of all states.
template <int N>
[[nodiscard]] SensorErrorRow sensor_error_row(Time time, const Layout& layout, const Eigen::Matrix<double, N, 1>& parameters,
                                              const Eigen::Matrix<double, N, 1>& variances);

/// Every block of the state with its covariance; P_n: local-level covariance of the first nine errors.
template <int N>
[[nodiscard]] StateRow state_row(const Layout& layout, const NavState& nav, const Eigen::Matrix<double, N, 1>& parameters,
                                 const Eigen::Matrix<double, N, N>& P, const Matrix9& P_n);

}  // namespace schuler::fusion
