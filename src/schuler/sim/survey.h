// The inertial unit and the receiver of a gravimetric survey over a disturbance of gravity.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/sim/anomaly.h"
#include "schuler/sim/path.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace schuler::sim {

/// Instruments as [PaperE] describes them: a constant error and white noise. Sigmas, each axis.
struct SurveyInstruments {
    double imu_rate = 2.0;           ///< Hz
    double gyro_bias = 0.0;          ///< rad/s
    double gyro_noise = 0.0;         ///< of a sample, rad/s
    double accel_bias = 0.0;         ///< m/s^2
    double accel_noise = 0.0;        ///< of a sample, m/s^2
    double gnss_rate = 1.0;          ///< Hz
    double gnss_position_bias = 0.0; ///< m
    double gnss_position_noise = 0.0;///< m
    double gnss_velocity_bias = 0.0; ///< m/s
    double gnss_velocity_noise = 0.0;///< m/s
};

/// Position and velocity in Earth-fixed axes, m and m/s.
struct EcefFix {
    Time time;
    Eigen::Vector3d position, velocity;
};

struct SurveyTruth {
    Time time;
    Kinematics kinematics;
    Eigen::Vector3d disturbance_n;   ///< north, east, down, m/s^2
};

struct SimulatedSurvey {
    std::vector<ImuIncrement> imu;   ///< body axes
    std::vector<EcefFix> fixes;      ///< of the IMU (no lever arm), from the first period on
    std::vector<SurveyTruth> truth;  ///< at the fixes
    Eigen::Vector3d gyro_bias, accel_bias;                ///< as drawn
};

/// @throws Error(Input) naming the setting that is unusable. The gnss rate divides the imu rate.
[[nodiscard]] SimulatedSurvey simulate_survey(const earth::Earth& earth, const TruthPath& path, const AnomalyTrack& anomaly,
                                              const SurveyInstruments& instruments, double duration, std::uint64_t seed);

}  // namespace schuler::sim
