// Best attainable accuracy of a survey from covariance analysis, to be reported together with every estimate.
#pragma once

#include "schuler/core/position.h"
#include "schuler/gravimetry/settings.h"

#include <vector>

namespace schuler::gravimetry {

/// A level survey with constant velocity, one fix per second from the start.
struct LevelSurvey {
    Geodetic start;
    Eigen::Vector3d v_eb_n = Eigen::Vector3d::Zero();  ///< m/s
    double heading = 0.0;                              ///< rad
    double sigma_position = 0.05;                      ///< white part of a fix, each axis, m
    double sigma_velocity = 0.05;                      ///< m/s
};

/// One sigma of the errors, north, east, down.
struct Attained {
    double t;                       ///< s from the start
    Eigen::Vector3d attitude_n;     ///< rad
    Eigen::Vector3d velocity_n;     ///< m/s
    Eigen::Vector3d position_n;     ///< m
    Eigen::Vector3d gyro_bias_n;    ///< rad/s
    Eigen::Vector3d disturbance_n;  ///< systematic plus random part, m/s^2
};

/// Sigmas of the NED components of attitude, velocity, position, gyro bias and disturbance from a covariance.
[[nodiscard]] Attained attained(const DisturbanceModel& disturbance, double t, const StateMatrix& P, const Eigen::Matrix3d& C_en,
                                const Eigen::Matrix3d& C_eb);

/// Propagates the covariance over the survey and reports it at each of `times` (whole seconds, ascending).
/// @throws Error(Input) from the disturbance model.
[[nodiscard]] std::vector<Attained> attainable(const SurveySettings& settings, const LevelSurvey& survey,
                                               const std::vector<int>& times);

}  // namespace schuler::gravimetry
