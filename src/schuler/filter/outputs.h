// Conversion of a filter's state and covariance to the reported rows.
#pragma once

#include "schuler/filter/result.h"
#include "schuler/filter/states/inertial_filter.h"

namespace schuler::filter {

/// Solution row from a geographic state and its 9 x 9 local-level error covariance.
[[nodiscard]] SolutionRow solution_row(const NavState& nav, const Matrix9& P_n);

/// The solution at a point of the body, `lever_arm_b` from the IMU (m, forward-right-down), from an estimate and its 9 x 9
/// local-level covariance. The sigmas include the contribution of the attitude, and for the velocity that of the angular rate,
/// whose error variance per axis is `rate_variance` (rad^2/s^2).
[[nodiscard]] SolutionRow solution_row_at(const Estimate& e, const Matrix9& P_n, const Eigen::Vector3d& lever_arm_b,
                                          const Eigen::Vector3d& rate_variance);
/// The same from a filter, whose rate is taken over an interval of `imu_interval` s.
template <class Frame>
[[nodiscard]] SolutionRow solution_row_at(const InertialModel& model, const InertialFilter<Frame>& f, const Matrix9& P_n,
                                          const Eigen::Vector3d& lever_arm_b, double imu_interval) {
    const Eigen::Vector3d noise = Eigen::Vector3d::Constant(model.gyro_psd / imu_interval);
    return solution_row_at(f.estimate(model), P_n, lever_arm_b,
                           noise + f.P.diagonal().template segment<3>(Layout::gyro_bias).cwiseMax(0.0));
}

/// What is reported: the motion of the unit, or of the antenna if the model says so, with its 9 x 9 local-level error covariance.
struct Reported {
    NavState nav;
    Matrix9 P;
};
[[nodiscard]] inline SolutionRow solution_row(const Reported& r) { return solution_row(r.nav, r.P); }
/// `undecided`: FilterRun::undecided.
template <class Frame>
[[nodiscard]] Reported reported(const InertialModel& model, const InertialFilter<Frame>& f, const Matrix9& undecided);

/// Sensor errors from the estimated parameters and the variances of all states.
[[nodiscard]] SensorErrorRow sensor_error_row(Time time, const Layout& layout, const StateVector& parameters,
                                              const StateVector& variances);

/// Every block of the state with its covariance; P_n: local-level covariance of the first nine errors.
[[nodiscard]] StateRow state_row(const Layout& layout, const NavState& nav, const StateVector& parameters, const StateMatrix& P,
                                 const Matrix9& P_n);

/// All states from index 9 on. `P`: covariance of all states.
[[nodiscard]] ParameterRow parameter_row(Time time, const Layout& layout, const StateVector& parameters, const StateMatrix& P);

/// The complete covariance of the states of a layout.
[[nodiscard]] CovarianceRow covariance_row(Time time, const Layout& layout, const StateMatrix& P);

}  // namespace schuler::filter
