// From a log to an attitude: the filters applied to whole recordings, forward, or forward and backward.
#pragma once

#include "schuler/ahrs/guard.h"
#include "schuler/ahrs/settings.h"
#include "schuler/ahrs/vector_filter_settings.h"
#include "schuler/core/samples.h"

#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace schuler::ahrs {

enum class FilterKind { Dcm, Quaternion, QuaternionPrinted, QuaternionCoupled, Mekf };

/// Attitude at an IMU epoch with one sigma of the small rotation about north, east and down (rad).
struct AttitudeRow {
    Time time;
    Eigen::Quaterniond q_nb;
    Eigen::Vector3d std_phi;
    Eigen::Vector3d gyro_bias;  ///< rad/s; that of the last rest for filters without that state
};

/// Speed over ground along the body's x axis.
struct SpeedSample {
    Time time;
    double speed = 0.0;  ///< m/s
    double std = 0.5;    ///< m/s
};

struct RunSettings {
    FilterKind filter = FilterKind::Mekf;
    bool offline = false;  ///< mekf: forward filter and backward smoother
    MekfSettings mekf;
    VectorFilterSettings vector;  ///< of the others; field and noises as given
};

/// Quantities estimated by the heading channel, at the end.
struct FieldFindings {
    Eigen::Vector3d hard_iron_b = Eigen::Vector3d::Zero();  ///< T
    double horizontal = 0.0, vertical = 0.0;                ///< T
    double delay = 0.0;                                     ///< s
};

struct RunResult {
    std::vector<AttitudeRow> rows;  ///< one per IMU sample after the start of the filter
    Counters counters;
    FieldFindings field;
    Eigen::Vector3d resting_rate = Eigen::Vector3d::Zero();  ///< rad/s, taken off all rates beforehand, and part of the biases
};

/// Runs a filter. Samples in body axes, in time order; a magnetometer sample is used with the first IMU sample that is not older.
/// @throws Error(Input) for invalid settings or an empty log.
[[nodiscard]] RunResult run(std::span<const ImuSample> imu, std::span<const MagSample> mag, std::span<const SpeedSample> speed,
                            const RunSettings& settings);

}  // namespace schuler::ahrs
