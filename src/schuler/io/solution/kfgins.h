// Projects of the KF-GINS program: its YAML settings and its text files of IMU increments and GNSS positions.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/io/text/text_input.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <vector>

namespace schuler::io {

/// Settings of a KF-GINS YAML file, in SI. Times are on the files' axis (seconds of the GPS week).
struct KfGinsProject {
    std::filesystem::path imu_path, gnss_path, output_path;  ///< as found: relative to the YAML file, else to the current folder
    int imu_columns = 7;
    double imu_rate_hz = 200.0;
    Time start;
    std::optional<Time> end;  ///< none: to the end of the IMU file (endtime -1)

    Geodetic position;                                      ///< of the IMU at the start; rad, m
    Eigen::Vector3d velocity_n = Eigen::Vector3d::Zero();   ///< north, east, down, m/s
    Eigen::Vector3d rpy = Eigen::Vector3d::Zero();          ///< roll, pitch, heading, rad
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();    ///< rad/s
    Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();   ///< m/s^2
    Eigen::Vector3d gyro_scale = Eigen::Vector3d::Zero();   ///< 1
    Eigen::Vector3d accel_scale = Eigen::Vector3d::Zero();  ///< 1

    Eigen::Vector3d std_position = Eigen::Vector3d::Zero();    ///< north, east, down, m
    Eigen::Vector3d std_velocity = Eigen::Vector3d::Zero();    ///< m/s
    Eigen::Vector3d std_rpy = Eigen::Vector3d::Zero();         ///< rad
    Eigen::Vector3d std_gyro_bias = Eigen::Vector3d::Zero();   ///< rad/s; if missing, that of the noise model
    Eigen::Vector3d std_accel_bias = Eigen::Vector3d::Zero();  ///< m/s^2
    Eigen::Vector3d std_gyro_scale = Eigen::Vector3d::Zero();
    Eigen::Vector3d std_accel_scale = Eigen::Vector3d::Zero();

    struct Noise {
        Eigen::Vector3d angle_random_walk = Eigen::Vector3d::Zero();     ///< rad/sqrt(s)
        Eigen::Vector3d velocity_random_walk = Eigen::Vector3d::Zero();  ///< m/s/sqrt(s)
        Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();             ///< steady-state sigma, rad/s
        Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();            ///< m/s^2
        Eigen::Vector3d gyro_scale = Eigen::Vector3d::Zero();            ///< 1
        Eigen::Vector3d accel_scale = Eigen::Vector3d::Zero();           ///< 1
        double correlation_time = 3600.0;                                ///< s, common to all of them
    } noise;
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< IMU to antenna, forward-right-down, m
};

/// Reads a project. Throws Error(Input) with file, line and key: not YAML, an unknown key (the nearest known one is suggested), a
/// wrong type, an invalid number of elements or range. `folder`: base of relative paths; empty: that of the YAML file.
[[nodiscard]] KfGinsProject read_kfgins_project(const TextInput& input, std::filesystem::path folder = {});

/// True if a YAML file is such a project (it has the keys imupath and gnsspath). Never throws on unusable content.
[[nodiscard]] bool is_kfgins_project(const TextInput& input);

struct KfGinsImu {
    std::vector<ImuSample> samples;  ///< increments over the interval that ends at the time stamp; forward-right-down
    RowCounts rows;
};
struct KfGinsGnss {
    std::vector<GnssFix> fixes;  ///< at the antenna, ellipsoidal height
    RowCounts rows;
};

/// Text of 7 columns: time (s), angle increments x y z (rad), velocity increments x y z (m/s). Errors as read_imu_csv.
[[nodiscard]] KfGinsImu read_kfgins_imu(const TextInput& input, WarningLog& log, Duration time_offset = {});
/// Text of 7 columns: time (s), latitude, longitude (deg), height (m), standard deviations north, east, down (m); 13 columns
/// with velocity north, east, down (m/s) and their standard deviations.
[[nodiscard]] KfGinsGnss read_kfgins_gnss(const TextInput& input, WarningLog& log, Duration time_offset = {});

}  // namespace schuler::io
