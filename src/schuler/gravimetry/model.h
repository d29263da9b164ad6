// The error model of the integrated gravimetric system [PaperE]: 27 states in Earth-fixed axes, more if the gravity disturbance
// has slope states. math.md section 4, converted to error = estimate minus truth for every state, including sensor errors. For
// analysis only, dense and at an instant; estimates come from the one filter (room filter), which has the same states as blocks.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"
#include "schuler/filter/states/disturbance.h"

#include <Eigen/Core>

namespace schuler::gravimetry {

/// First index of three components each. All are in Earth-fixed axes except the inertial sensor errors (body axes) and the
/// disturbance (DisturbanceAxes).
enum StateIndex : int {
    position = 0,        ///< m
    velocity = 3,        ///< m/s
    attitude = 6,        ///< phi, rad: C_est = (I - [phi x]) C
    accel_bias = 9,      ///< m/s^2
    gyro_bias = 12,      ///< rad/s
    gnss_position = 15,  ///< systematic error of the receiver, m
    gnss_velocity = 18,  ///< m/s
    systematic = 21,     ///< constant part of the disturbance, m/s^2
    random = 24,         ///< its random part, m/s^2
    slope = 27,          ///< of the systematic (polynomial) or random part, m/s^2 per metre along the track
    curvature = 30,      ///< second derivative of the same, m/s^2 per square metre
};
/// Capacity for every model; 36 so that columns are whole vectors. States that a model does not have keep zero variance.
inline constexpr int max_states = 36;
using StateVector = Eigen::Matrix<double, max_states, 1>;
using StateMatrix = Eigen::Matrix<double, max_states, max_states>;
using NoiseMatrix = Eigen::Matrix<double, max_states, 15>;
using GnssRows = Eigen::Matrix<double, 6, max_states>;

using filter::DisturbanceAxes;
using filter::DisturbanceKind;
using filter::DisturbanceModel;

/// Error states of a model: 27, 30 or 33.
[[nodiscard]] int states_of(const DisturbanceModel& disturbance);

/// White noise of the inertial sensors and the random walks of their biases, one axis.
struct SensorNoise {
    double gyro_psd = 0.0;        ///< rad^2/s
    double accel_psd = 0.0;       ///< m^2/s^3
    double gyro_bias_psd = 0.0;   ///< rad^2/s^3; 0: constant, as in [PaperE]
    double accel_bias_psd = 0.0;  ///< m^2/s^5
};

/// Motion at which F is evaluated: at an instant, or means over a step.
struct Motion {
    Ecef position;
    Eigen::Vector3d v_eb_e = Eigen::Vector3d::Zero();  ///< m/s
    Eigen::Matrix3d C_eb = Eigen::Matrix3d::Identity();
    Eigen::Vector3d f_e = Eigen::Vector3d::Zero();  ///< specific force, m/s^2
};

/// F: dx/dt = F x + G w. Derivatives of the filter's step in Earth-fixed axes, except for the rotation of a local-level
/// disturbance by a position error: 1.6e-11 1/s^2 for 10 mGal, a hundred-thousandth of the gravity gradient. That gradient is
/// that of the Earth's gravity model, including its centrifugal part.
[[nodiscard]] StateMatrix gravity_error_dynamics(const earth::Earth& earth, const DisturbanceModel& disturbance,
                                                 const Motion& motion);

/// G for w = (gyro noise, accelerometer noise, disturbance, accelerometer and gyro bias random walks) of unit densities, sensor
/// noise as measured minus true: columns are scaled by the roots of the densities of `noise` and of the disturbance model.
[[nodiscard]] NoiseMatrix gravity_noise_input(const earth::Earth& earth, const DisturbanceModel& disturbance,
                                              const SensorNoise& noise, const Motion& motion);

/// H for (position, velocity) of a receiver, computed minus measured, Earth-fixed axes. lever_arm_b: IMU to antenna, m; w_eb_b:
/// rate of the body relative to the Earth, rad/s.
[[nodiscard]] GnssRows gravity_gnss_rows(const Eigen::Matrix3d& C_eb, const Eigen::Vector3d& lever_arm_b,
                                         const Eigen::Vector3d& w_eb_b);

}  // namespace schuler::gravimetry
