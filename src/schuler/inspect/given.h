// What the user states about a data set. Inspection uses it in reading and judging the files, determines what is not given, and
// reports contradictions with the data.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace schuler::inspect {

/// A file with its role in the data set. Without a path, columns and scale are those of the log that is found for the role.
struct GivenFile {
    std::filesystem::path path;                  ///< empty: not given
    std::string name;                            ///< as given by the user
    std::map<std::string, std::string> columns;  ///< canonical name = the file's name
    std::map<std::string, double> scale;         ///< canonical name = factor to the canonical unit
    double time_offset = 0.0;                    ///< s, added to the file's times, whether or not the file is named
    std::vector<std::filesystem::path> parts;    ///< further files of the same log
};

/// Fixes that are in no file of the data set: computed from raw measurements, epoch by epoch.
struct ComputedFixes {
    std::string source;          ///< name of the log of raw measurements
    std::vector<GnssFix> fixes;  ///< GPS time
};

struct Given {
    std::set<std::string> keys;  ///< of all given settings: "imu.axes"
    GivenFile imu, gnss, baro, mag, reference;
    ComputedFixes computed;       ///< used if no log of fixes is found, to determine axes, vehicle and clocks
    bool find_logs = true;        ///< the folder's other files may be the IMU and GNSS logs and the reference
    bool find_imu = true;         ///< ... the IMU log, even if others are named
    bool find_gnss = true;        ///< ... the log of fixes, even if others are named
    bool find_companions = true;  ///< ... the barometer and magnetometer logs
    bool weighs_field = false;    ///< the user of the magnetometer weights its samples: a disturbed one is not excluded
    std::map<std::string, std::string> fix_codes;
    std::string vehicle;                                 ///< "car", ...
    std::string axes;                                    ///< as given
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();  ///< of `axes`
    std::optional<Eigen::Vector3d> mounting_rpy;         ///< rad; empty if it is to be estimated
    std::optional<double> gyro_bias, gyro_noise;         ///< from imu.grade: one sigma at switch-on, rad/s; rad/sqrt(s)
    std::optional<double> accel_bias;                    ///< likewise, m/s^2
    std::optional<bool> use_velocity;                    ///< of the fixes
    std::optional<double> latency, velocity_latency, height_latency, velocity_down_latency;  ///< s

    [[nodiscard]] bool has(const std::string& key) const { return keys.contains(key); }
};

}  // namespace schuler::inspect
