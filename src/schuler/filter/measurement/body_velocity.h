// Velocity relative to the Earth in body axes: Doppler log, DVL.
#pragma once

#include "schuler/filter/measurement/measurement.h"
#include "schuler/filter/settings.h"

namespace schuler::filter {

/// Velocity (m/s, body axes) of a log at its lever arm (IMU to log, m, body), as measured: (1 + scale) (v + misalignment x v),
/// misaligned about the right and down axes (the forward axis has no effect for forward motion); scale and misalignment are
/// included if they are states. variance in m^2/s^2. The rows include the Earth rate resolved with a wrong attitude.
[[nodiscard]] Measurement body_velocity(const Estimate& estimate, const Eigen::Vector3d& measured_b, double variance,
                                        const Eigen::Vector3d& lever_arm_b);

/// The measurement of a sample with the sigma and lever arm of the settings.
[[nodiscard]] Measurement measurement_of(const Estimate& estimate, const BodyVelocitySample& sample, const Settings& settings);

}  // namespace schuler::filter
