// Longest time that a mechanization may run before the estimated errors must be fed back to it.
#pragma once

namespace schuler::filter {

/// Largest initial errors and sensor errors.
struct InertialErrorBounds {
    double attitude = 0.0;  ///< rad
    double gyro = 0.0;      ///< rad/s
    double accel = 0.0;     ///< m/s^2
};

/// Bounds at three sigma.
[[nodiscard]] constexpr InertialErrorBounds three_sigma(double attitude, double gyro, double accel) {
    return {3.0 * attitude, 3.0 * gyro, 3.0 * accel};
}

/// Attitude error (rad) that grows in t seconds without correction, for t well below the Schuler period: gyro t +
/// [(attitude g + accel) t^2 / 2 + g gyro t^3 / 6] / R [PaperA:3.4].
[[nodiscard]] double attitude_growth(const InertialErrorBounds& bounds, double t);

/// Time (s) after which that growth reaches `allowed` (rad, positive), up to which the linear error model is valid. Between 1 s
/// and a quarter of the Schuler period.
[[nodiscard]] double correction_period(const InertialErrorBounds& bounds, double allowed);

}  // namespace schuler::filter
