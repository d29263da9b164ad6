// What a user says about a data set. Inspection takes it as true where it reads and judges the files, finds what is not in it, and
// says where the data contradict it.
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace schuler::inspect {

/// A file with its role in the data set.
struct GivenFile {
    std::filesystem::path path;                  ///< empty: not named
    std::string name;                            ///< as the user writes it
    std::map<std::string, std::string> columns;  ///< canonical name = the file's name
    std::map<std::string, double> scale;         ///< canonical name = factor to the canonical unit
    double time_offset = 0.0;                    ///< s, added to the file's times, named or not
};

struct Given {
    std::set<std::string> keys;  ///< of all settings that are given: "imu.axes"
    GivenFile imu, gnss, baro, mag, reference;
    bool find_logs = true;      ///< the folder's other files may be the IMU and GNSS logs and the reference
    bool find_imu = true;       ///< ... the IMU's log, whatever else is named
    bool find_aids = true;      ///< ... the barometer's and the magnetometer's
    bool weighs_field = false;  ///< whoever reads the magnetometer weighs its samples: a disturbed one is not left out
    std::map<std::string, std::string> fix_codes;
    std::string vehicle;                                 ///< "car", ...
    std::string axes;                                    ///< as written
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();  ///< of `axes`
    std::optional<Eigen::Vector3d> mounting_rpy;         ///< rad; empty where it is to be estimated
    std::optional<double> gyro_bias, gyro_noise;         ///< of imu.grade: one sigma at switch-on, rad/s; rad/sqrt(s)
    std::optional<double> latency, velocity_latency, height_latency, velocity_down_latency;  ///< s

    [[nodiscard]] bool has(const std::string& key) const { return keys.contains(key); }
};

}  // namespace schuler::inspect
