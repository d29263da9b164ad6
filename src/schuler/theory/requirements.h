// Sensor accuracy required by a position budget over an outage, and the longest outage for given sensors.
#pragma once

#include "schuler/theory/level_dynamics.h"

namespace schuler::theory {

/// Largest constant sensor error [PaperA:1.4.5, 1.4.7] that alone stays within `budget` m through an outage of UP TO `outage` s.
/// The effect of an accelerometer error decreases after half a Schuler period: the maximum before that is used.
struct Requirement {
    double accel;  ///< m/s^2
    double gyro;   ///< rad/s
};
/// @throws Error(Input) for a budget or outage that is not positive; key "budget" or "outage".
[[nodiscard]] Requirement requirement(const Pendulum& p, double budget, double outage);

/// One sigma of the sensors of one axis, SI units.
struct SensorSigmas {
    double accel_bias, gyro_bias;    ///< m/s^2, rad/s: residuals after in-flight calibration
    double accel_noise, gyro_noise;  ///< m/s/sqrt(s), rad/sqrt(s)
};

/// One sigma of the horizontal position error of an axis after t s with such sensors and ideal initialisation: biases as in
/// Pendulum, noise by its integrals N_a t^(3/2) / sqrt(3) and g N_g t^(5/2) / sqrt(20), valid well below the Schuler period.
[[nodiscard]] double position_sigma(const Pendulum& p, const SensorSigmas& s, double t);

/// Longest outage (s) within `budget`; at most `longest`.
[[nodiscard]] double longest_outage(const Pendulum& p, const SensorSigmas& s, double budget, double longest = 86400.0);

}  // namespace schuler::theory
