// From a scenario to the logs of its instruments, and the truth.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/sensor/gnss_errors.h"
#include "schuler/sensor/grades.h"
#include "schuler/sim/anomaly.h"
#include "schuler/sim/path.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace schuler::sim {

struct ImuSettings {
    double rate = 100.0;                                 ///< Hz
    ImuKind kind = ImuKind::Increments;                  ///< rates are increments divided by the sample interval
    sensor::ImuErrorModel errors;                        ///< all zero: perfect
    Eigen::Vector3d mounting = Eigen::Vector3d::Zero();  ///< roll, pitch, yaw from body to sensor axes, rad
    double warm_up = 0.0;                                ///< K, final rise above the calibration temperature
    double warm_up_time = 600.0;                         ///< s, its time constant
};

/// A receiver's own solution. Position and velocity errors are white plus Gauss-Markov (paper A, (3.2.1) and (3.2.2)), north,
/// east, down.
struct GnssSettings {
    double rate = 1.0;                                                  ///< Hz; 0: no receiver
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();              ///< IMU to antenna, body axes, m
    Eigen::Vector3d white_position = Eigen::Vector3d(1.0, 1.0, 2.0);    ///< sigma, m
    Eigen::Vector3d white_velocity = Eigen::Vector3d(0.05, 0.05, 0.1);  ///< sigma, m/s
    sensor::GnssErrorModel errors;                                      ///< the slowly varying parts
    std::vector<double> constellation_changes;                          ///< s, in order: the first fix at or after each
    double position_latency = 0.0;                                      ///< s: the fix stamped t is valid at t - latency
    double velocity_latency = 0.0;                                      ///< s
    FixType fix = FixType::Autonomous;
};

/// Sigma that such a receiver states for its fixes: white and slow part together.
[[nodiscard]] Eigen::Vector3d stated_position_sigma(const GnssSettings& settings);
[[nodiscard]] Eigen::Vector3d stated_velocity_sigma(const GnssSettings& settings);

/// A barometric altimeter at the IMU.
struct BaroSettings {
    double rate = 0.0;       ///< Hz; 0: none
    double white = 0.5;      ///< sigma, m
    double bias = 0.0;       ///< constant, sigma over runs, m
    double bias_walk = 0.0;  ///< m/sqrt(s)
    double bias_time = 0.0;  ///< s; not 0: the bias is a Gauss-Markov process with this correlation time instead of a random walk
    bool pressure = false;   ///< the log has the static pressure, which its reader converts with the standard atmosphere
    double sea_level_pressure = 101325.0;  ///< Pa, actual
    double temperature_offset = 0.0;       ///< K, offset of the actual temperature from the standard atmosphere at every height
};

/// A magnetometer in the axes of the IMU. The field is constant; iron of the body adds a constant (hard) and distorts (soft).
struct MagSettings {
    double rate = 0.0;         ///< Hz; 0: none
    double field = 50e-6;      ///< T
    double declination = 0.0;  ///< rad, east positive
    double inclination = 1.1;  ///< rad, down positive
    double white = 0.0;        ///< sigma, T
    double hard_iron = 0.0;    ///< sigma over runs of each component, T
    double soft_iron = 0.0;    ///< sigma over runs of each of nine coefficients
};

enum class Channel { Gnss, Baro, Imu };

/// The channel has no output for start < t < start + duration, seconds of the scenario.
struct SimulatedOutage {
    double start = 0.0;
    double duration = 0.0;
    Channel channel = Channel::Gnss;
};

/// Faults. Sizes: m (receiver, barometer); rad/s or m/s^2 of an IMU's gyros or accelerometers; a rate is that per second.
enum class FaultKind {
    Step,      ///< an offset
    Ramp,      ///< an offset that grows by `size` per second, position only
    Drift,     ///< the same with the corresponding velocity
    Velocity,  ///< an offset of the receiver's velocity
    Freeze,    ///< the values of the last good sample
    Noise,     ///< white noise of sigma `size`
    Dropout,   ///< no samples
    Gyro,      ///< an offset of the gyros
    Accel,     ///< an offset of the accelerometers
    Saturate   ///< gyros limited to a largest measured value of `size`
};
struct Fault {
    Channel channel = Channel::Gnss;
    FaultKind kind = FaultKind::Step;
    double start = 0.0;     ///< s of the scenario
    double duration = 1e9;  ///< s
    double size = 0.0;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< north, east, down (receiver) or sensor axes; made a unit vector
};

struct Scenario {
    std::uint64_t seed = 1;
    double duration = 600.0;  ///< s
    Time origin;              ///< time of the first instant
    earth::Earth earth;
    PathSettings path;
    std::vector<AnomalyPart> anomaly;  ///< gravity disturbance along the path, in addition to the Earth's model
    GroundField anomaly_field;         ///< and gravity disturbance over the ground; empty: none
    ImuSettings imu;
    GnssSettings gnss;
    BaroSettings baro;
    MagSettings mag;
    std::vector<Fault> faults;     ///< in the log, as seen by the readers
    double reference_rate = 10.0;  ///< of the truth, Hz
    std::vector<SimulatedOutage> outages;

    /// Gravity differs from the Earth's model.
    [[nodiscard]] bool disturbed() const { return !anomaly.empty() || anomaly_field; }
};

/// True sensor errors in sensor axes, and the gravity disturbance, at the instants of the reference.
struct SensorTruth {
    Time time;
    Eigen::Vector3d gyro_bias;                                ///< turn-on plus in-run, rad/s
    Eigen::Vector3d accel_bias;                               ///< m/s^2
    Eigen::Vector3d disturbance_n = Eigen::Vector3d::Zero();  ///< north, east, down, m/s^2
};

/// Slowly varying errors of the receiver at the instants of its fixes, and of the barometer at those of its samples.
struct GnssTruth {
    Time time;
    Eigen::Vector3d position;  ///< north, east, down, m
    Eigen::Vector3d velocity;  ///< m/s
};
struct BaroTruth {
    Time time;
    double bias;  ///< m
};

struct SimulatedData {
    /// imu stamped at the end of each sample, sensor axes; gnss at the antenna; reference of the IMU, from the first instant on.
    Recording recording;
    ImuKind imu_kind = ImuKind::Increments;
    std::vector<SensorTruth> sensor_truth;                    ///< same number as the reference
    std::vector<GnssTruth> gnss_truth;                        ///< same number as the fixes
    std::vector<BaroTruth> baro_truth;                        ///< same number as the barometer's samples
    Eigen::Matrix3d gyro_gain = Eigen::Matrix3d::Identity();  ///< I plus scale errors and misalignments
    Eigen::Matrix3d accel_gain = Eigen::Matrix3d::Identity();
};

/// Simulates a scenario. The same scenario gives the same numbers; each noise has a separate random stream, so that one channel
/// does not affect another. Throws Error(Input) that names the invalid setting.
[[nodiscard]] SimulatedData simulate(const Scenario& scenario);

}  // namespace schuler::sim
