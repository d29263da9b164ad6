// Velocity against the Earth in body axes: Doppler log, DVL.
#pragma once

#include "schuler/filter/measurement/measurement.h"

namespace schuler::filter {

/// Velocity (m/s, body axes) of a log at its lever arm (IMU to log, m, body), as it shows it: (1 + scale) (v + misalignment x v),
/// misaligned about the right and down axes (about the forward axis nothing changes for what moves forward); scale and misalignment
/// take part where they are states. variance in m^2/s^2. The Earth's rate seen from a wrong attitude is part of the rows.
[[nodiscard]] Measurement body_velocity(const Estimate& estimate, const Eigen::Vector3d& measured_b, double variance,
                                        const Eigen::Vector3d& lever_arm_b);

}  // namespace schuler::filter
