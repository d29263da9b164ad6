// A car drive with known truth, written as CSV logs the way users have them.
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <functional>
#include <string>

namespace schuler::inspect::test {

struct CarLog {
    double duration = 120.0;  // s, still for the first 20
    double imu_rate = 100.0, gnss_rate = 5.0;
    Eigen::Matrix3d C_sb = Eigen::Matrix3d::Identity();     // body (forward-right-down) to sensor
    double position_latency = 0.0, velocity_latency = 0.0;  // s, older than the stamp
    double down_latency = 0.0;                              // s, of the vertical velocity beyond that of the horizontal one
    double bob_frequency = 0.0, bob_speed = 0.0;            // Hz, m/s: up and down while it moves
    double imu_start = 1000.0, gnss_start = 1000.0;         // s, the numbers of the files' first epochs (same instant)
    double time_factor = 1.0;                               // written time = seconds * factor
    double gyro_factor = 1.0, accel_factor = 1.0;           // written = SI * factor
    std::string imu_header = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2";
    std::string gnss_header = "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s";
    double angle_factor = 1.0;  // of latitude and longitude, from degrees
    bool write_velocity = true;
    double position_noise = 0.01;  // m, one sigma of an axis
    bool increments = false;       // per-sample increments instead of rates
    std::string separator = ",";
    std::string imu_name = "imu.csv", gnss_name = "gnss.csv";
    Eigen::Vector3d gyro_bias{0.002, -0.001, 0.0015};  // rad/s, sensor axes
    Eigen::Vector3d accel_bias{0.05, -0.04, 0.06};     // m/s^2
};

/// Writes the logs of `car` into the folder (created where absent).
void write_car(const std::filesystem::path& folder, const CarLog& car);

/// A folder of this name under the test's temporary place, empty.
[[nodiscard]] std::filesystem::path fresh_folder(const std::string& name);
void write_file(const std::filesystem::path& path, const std::string& content);

}  // namespace schuler::inspect::test
