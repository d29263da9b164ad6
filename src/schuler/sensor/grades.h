// Error models of inertial instruments, and a table of grades and devices by name.
#pragma once

#include <string_view>
#include <vector>

namespace schuler::sensor {

/// Error model of an inertial measurement unit: three identical gyros and three identical accelerometers, SI units, one sigma.
/// All zero is a perfect instrument. Simulator and filter use the same struct, except in studies of the difference.
///
/// Measured = (I + S + M) true + turn-on bias + in-run bias + rate walk + flicker + temperature and g errors + white noise, then
/// limited to the range and rounded to the quantum, where S is diagonal with the scale errors, M has the six independent
/// misalignments off its diagonal, the turn-on bias is constant in a run and the in-run bias is a stationary first-order
/// Gauss-Markov process (correlation exp(-t/bias_time)).
struct ImuErrorModel {
    double gyro_noise = 0.0;         ///< angle random walk: root of the two-sided density of the rate noise, rad/sqrt(s)
    double gyro_bias = 0.0;          ///< in-run bias, rad/s
    double gyro_bias_time = 3600.0;  ///< its correlation time, s
    double gyro_turn_on_bias = 0.0;  ///< constant bias, new at each switch-on, rad/s
    double gyro_scale = 0.0;         ///< scale-factor error
    double gyro_misalignment = 0.0;  ///< each of the six axis misalignments, rad
    double gyro_quantum = 0.0;       ///< least count of the accumulated angle, rad (0: none)
    double gyro_rate_walk = 0.0;     ///< random walk of the bias, rad/s/sqrt(s)
    double gyro_flicker = 0.0;      ///< bias instability B of [IEEE952]: 1/f noise, the Allan deviation's floor is 0.664 B, rad/s
    double gyro_temperature = 0.0;  ///< bias per kelvin from the calibration temperature, each axis, rad/s/K
    double gyro_g = 0.0;            ///< bias per unit of specific force, each of nine coefficients, rad/s/(m/s^2)
    double gyro_range = 0.0;        ///< largest measurable rate, rad/s (0: no limit)

    double accel_noise = 0.0;         ///< velocity random walk, m/s/sqrt(s)
    double accel_bias = 0.0;          ///< in-run bias, m/s^2
    double accel_bias_time = 3600.0;  ///< its correlation time, s
    double accel_turn_on_bias = 0.0;  ///< constant bias, new at each switch-on, m/s^2
    double accel_scale = 0.0;         ///< scale-factor error
    double accel_misalignment = 0.0;  ///< each of the six axis misalignments, rad
    double accel_quantum = 0.0;       ///< least count of the accumulated velocity, m/s (0: none)
    double accel_rate_walk = 0.0;     ///< random walk of the bias, m/s^2/sqrt(s)
    double accel_flicker = 0.0;       ///< bias instability B, m/s^2
    double accel_temperature = 0.0;   ///< bias per kelvin from the calibration temperature, m/s^2/K
    double accel_range = 0.0;         ///< largest measurable specific force, m/s^2 (0: no limit)

    /// One sigma of the total bias at switch-on (turn-on, in-run, flicker): the initial uncertainty of a filter. rad/s.
    [[nodiscard]] double gyro_initial_bias() const;
    /// Likewise for the accelerometers, m/s^2.
    [[nodiscard]] double accel_initial_bias() const;
};

/// The model of a grade (consumer, mems, tactical, navigation), of a device (hg9900, ...) or of the "perfect" instrument.
/// Case, '-' and '_' are ignored. Throws Error(Input) that lists the known names.
[[nodiscard]] ImuErrorModel imu_grade(std::string_view name);

/// The known names, worst first.
[[nodiscard]] std::vector<std::string_view> imu_grade_names();

}  // namespace schuler::sensor
