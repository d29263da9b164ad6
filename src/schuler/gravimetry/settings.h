// Assumptions of a covariance analysis of a survey: instruments, priors, the model of the disturbance.
#pragma once

#include "schuler/gravimetry/model.h"

namespace schuler::gravimetry {

/// One-sigma priors. Vectors are north, east, down; scalars apply to each axis.
struct Prior {
    Eigen::Vector3d attitude_n = Eigen::Vector3d::Constant(1e-4);       ///< rad
    double velocity = 0.01;                                             ///< m/s
    double position = 10.0;                                             ///< m
    double accel_bias = 1e-6;                                           ///< m/s^2
    double gyro_bias = 4.8e-8;                                          ///< rad/s
    Eigen::Vector3d gnss_position_n = Eigen::Vector3d::Constant(0.05);  ///< systematic error of the receiver, m
    double gnss_velocity = 0.05;                                        ///< m/s
    Eigen::Vector3d disturbance_n = Eigen::Vector3d::Constant(1e-4);    ///< systematic part, m/s^2
    double slope = 0.0;      ///< of a ramp, m/s^2 per metre (per second if the disturbance is a function of time)
    double curvature = 0.0;  ///< second derivative of a parabola, m/s^2 per square metre (or second)
};

struct SurveySettings {
    earth::Earth earth;
    DisturbanceModel disturbance;
    SensorNoise noise;
    Prior prior;
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< IMU to antenna, m
};

/// Initial P with the errors of the prior; the random part of the disturbance is in its stationary state.
[[nodiscard]] StateMatrix prior_covariance(const SurveySettings& settings, const Ecef& position);

}  // namespace schuler::gravimetry
