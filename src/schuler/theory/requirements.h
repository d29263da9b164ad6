// What sensors a position budget asks for over an outage, and how long an outage given sensors allow.
#pragma once

#include "schuler/theory/level_dynamics.h"

namespace schuler::theory {

/// Largest constant sensor error [PaperA:1.4.5, 1.4.7] that alone keeps within `budget` m through an outage of UP TO `outage` s. The accelerometer's error swings back after
/// half a Schuler period: the largest before counts.
struct Requirement {
    double accel;  ///< m/s^2
    double gyro;   ///< rad/s
};
/// @throws Error(Input) for a budget or outage that is not positive; key "budget" or "outage".
[[nodiscard]] Requirement requirement(const Pendulum& p, double budget, double outage);

/// One sigma of the sensors of an axis, SI units.
struct SensorSigmas {
    double accel_bias, gyro_bias;    ///< m/s^2, rad/s: what calibration in flight leaves
    double accel_noise, gyro_noise;  ///< m/s/sqrt(s), rad/sqrt(s)
};

/// One sigma of the horizontal position error of an axis after t s with such sensors, perfectly started: biases as Pendulum has them,
/// noise by its integrals N_a t^(3/2) / sqrt(3) and g N_g t^(5/2) / sqrt(20), which hold well below the Schuler period.
[[nodiscard]] double position_sigma(const Pendulum& p, const SensorSigmas& s, double t);

/// Longest outage (s) in which that stays within `budget`; at most `longest`.
[[nodiscard]] double longest_outage(const Pendulum& p, const SensorSigmas& s, double budget, double longest = 86400.0);

}  // namespace schuler::theory
