// From a filter's state and covariance to the rows that are reported.
#pragma once

#include "schuler/filter/inertial_filter.h"
#include "schuler/filter/result.h"

namespace schuler::filter {

/// Solution row from a geographic state and its 9 x 9 local-level error covariance.
[[nodiscard]] SolutionRow solution_row(const NavState& nav, const Matrix9& P_n);

/// Sensor errors from the estimated parameters and the variances of all states.
[[nodiscard]] SensorErrorRow sensor_error_row(Time time, const Layout& layout, const StateVector& parameters, const StateVector& variances);

/// Every block of the state with its covariance; P_n: local-level covariance of the first nine errors.
[[nodiscard]] StateRow state_row(const Layout& layout, const NavState& nav, const StateVector& parameters, const StateMatrix& P,
                                 const Matrix9& P_n);

/// Every state from 9 on. `P`: of all states.
[[nodiscard]] ParameterRow parameter_row(Time time, const Layout& layout, const StateVector& parameters, const StateMatrix& P);

/// The whole covariance of the states of a layout.
[[nodiscard]] CovarianceRow covariance_row(Time time, const Layout& layout, const StateMatrix& P);

}  // namespace schuler::filter
