// Scalar gravimetry the classical way, beside the filter: differentiate the fixes, subtract, low-pass.
#pragma once

#include "schuler/gravimetry/survey_run.h"

#include <vector>

namespace schuler::gravimetry {

/// Half amplitude at a period (s) of a Gaussian kernel without phase: its standard deviation is period sqrt(ln 2 / 2)/pi.
/// Ends are filtered with what is there. t rises.
[[nodiscard]] std::vector<double> low_passed(const std::vector<double>& t, const std::vector<double>& x, double period);

/// Gravity disturbance (down) at the epochs of a survey over these fixes, m/s^2; lever_arm_b: IMU to antenna, m. Normal gravity and the Eotvos term taken off the second difference
/// of the fixes' heights less the vertical specific force, low-passed. Attitude and accelerometer errors are the forward filter's.
/// The first and last value are those of their neighbours. @throws Error(Input) for fewer than three epochs.
[[nodiscard]] std::vector<double> classical_disturbance(const earth::Earth& earth, const Eigen::Vector3d& lever_arm_b,
                                                        const std::vector<GnssFix>& fixes,
                                                        const std::vector<SurveyEpoch>& forward, double period);

}  // namespace schuler::gravimetry
