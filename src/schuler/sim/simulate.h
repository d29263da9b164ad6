// From a scenario to what its instruments would have logged, and the truth.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/sensor/grades.h"
#include "schuler/sim/anomaly.h"
#include "schuler/sim/path.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace schuler::sim {

struct ImuSettings {
    double rate = 100.0;                                       ///< Hz
    ImuKind kind = ImuKind::Increments;                        ///< rates are increments divided by the sample time
    sensor::ImuErrorModel errors;                              ///< all zero: perfect
    Eigen::Vector3d mounting = Eigen::Vector3d::Zero();        ///< roll, pitch, yaw from body to sensor axes, rad
};

/// A receiver's own solution. Position and velocity errors are white plus Gauss-Markov (paper A, (3.2.1) and (3.2.2)), north,
/// east, down.
struct GnssSettings {
    double rate = 1.0;                                                         ///< Hz; 0: no receiver
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();                     ///< IMU to antenna, body axes, m
    Eigen::Vector3d white_position = Eigen::Vector3d(1.0, 1.0, 2.0);           ///< sigma, m
    Eigen::Vector3d correlated_position = Eigen::Vector3d::Zero();             ///< sigma, m
    Eigen::Vector3d white_velocity = Eigen::Vector3d(0.05, 0.05, 0.1);         ///< sigma, m/s
    Eigen::Vector3d correlated_velocity = Eigen::Vector3d::Zero();             ///< sigma, m/s
    double correlated_time = 300.0;                                            ///< s
    double position_latency = 0.0;                                             ///< s: the fix stamped t holds for t - latency
    double velocity_latency = 0.0;                                             ///< s
    FixType fix = FixType::Autonomous;
};

/// A barometric altimeter at the IMU.
struct BaroSettings {
    double rate = 0.0;               ///< Hz; 0: none
    double white = 0.5;              ///< sigma, m
    double bias = 0.0;               ///< constant, sigma over runs, m
    double bias_walk = 0.0;          ///< m/sqrt(s)
};

enum class Channel { Gnss, Baro };

/// The channel is silent for start < t < start + duration, seconds of the scenario.
struct SimulatedOutage {
    double start = 0.0;
    double duration = 0.0;
    Channel channel = Channel::Gnss;
};

struct Scenario {
    std::uint64_t seed = 1;
    double duration = 600.0;         ///< s
    Time origin;                     ///< time of the first instant
    earth::Earth earth;
    PathSettings path;
    std::vector<AnomalyPart> anomaly;   ///< of gravity along the path, beyond the Earth's model
    ImuSettings imu;
    GnssSettings gnss;
    BaroSettings baro;
    double reference_rate = 10.0;    ///< of the truth, Hz
    std::vector<SimulatedOutage> outages;
};

/// True sensor errors in sensor axes, and the disturbance of gravity, at the instants of the reference.
struct SensorTruth {
    Time time;
    Eigen::Vector3d gyro_bias;       ///< turn-on plus in-run, rad/s
    Eigen::Vector3d accel_bias;      ///< m/s^2
    Eigen::Vector3d disturbance_n = Eigen::Vector3d::Zero();   ///< north, east, down, m/s^2
};

struct SimulatedData {
    /// imu stamped at the end of each sample, sensor axes; gnss at the antenna; reference of the IMU, from the first instant on.
    Recording recording;
    ImuKind imu_kind = ImuKind::Increments;
    std::vector<SensorTruth> sensor_truth;   ///< as many as the reference
    Eigen::Matrix3d gyro_gain = Eigen::Matrix3d::Identity();    ///< I plus scale errors and misalignments
    Eigen::Matrix3d accel_gain = Eigen::Matrix3d::Identity();
};

/// Simulates a scenario. The same scenario gives the same numbers; each noise has a random stream of its own, so that one
/// channel does not change another. Throws Error(Input) naming the setting that is unusable.
[[nodiscard]] SimulatedData simulate(const Scenario& scenario);

}  // namespace schuler::sim
