// Classical scalar gravimetry, independent of the filter: differentiate the fixes, subtract, low-pass.
#pragma once

#include "schuler/gravimetry/survey_run.h"

#include <vector>

namespace schuler::gravimetry {

/// Zero-phase Gaussian low-pass with half amplitude at a period (s): the kernel's standard deviation is period sqrt(ln 2 / 2)/pi.
/// At the ends only the available values are used. t ascending.
[[nodiscard]] std::vector<double> low_passed(const std::vector<double>& t, const std::vector<double>& x, double period);

/// Gravity disturbance (down) at the epochs of a survey over these fixes, m/s^2; lever_arm_b: IMU to antenna, m. Second difference of the fixes'
/// heights minus the vertical specific force, reduced by normal gravity and the Eotvos term, and low-passed. Attitude and accelerometer errors
/// are the forward filter's. The first and last values are copied from their neighbours. @throws Error(Input) for fewer than three epochs.
[[nodiscard]] std::vector<double> classical_disturbance(const earth::Earth& earth, const Eigen::Vector3d& lever_arm_b,
                                                        const std::vector<GnssFix>& fixes,
                                                        const std::vector<SurveyEpoch>& forward, double period);

}  // namespace schuler::gravimetry
