// The one state layout of the loosely coupled filter: named blocks, one meaning per index.
#pragma once

namespace schuler::fusion {

struct Settings;

/// Offsets of the error-state blocks. The first fifteen are always there; an absent optional block has offset -1.
struct Layout {
    static constexpr int position = 0;      ///< 3, m, in the axes of the mechanization's frame
    static constexpr int velocity = 3;      ///< 3, m/s
    static constexpr int attitude = 6;      ///< 3, rad
    static constexpr int gyro_bias = 9;     ///< 3, rad/s, body
    static constexpr int accel_bias = 12;   ///< 3, m/s^2, body
    int gyro_scale = -1;                    ///< 3
    int accel_scale = -1;                   ///< 3
    int gyro_misalignment = -1;             ///< 6, rad: what x measures of y and z, y of x and z, z of x and y
    int accel_misalignment = -1;            ///< 6, rad, in the same order
    int mounting = -1;                      ///< 2: pitch and yaw of the vehicle's forward axis in body axes, rad
    int axle = -1;                          ///< 1, m, distance of the IMU ahead of the unsteered axle
    int lever_arm = -1;                     ///< 3, m, body
    int baro_bias = -1;                     ///< 1, m
    int mag_bias = -1;                      ///< 1, rad, heading offset of the magnetometer
    int gnss_position = -1;                 ///< 3, m, correlated GNSS position error, north-east-down
    int gnss_velocity = -1;                 ///< 3, m/s, correlated GNSS velocity error, north-east-down
    int size = 15;
};

/// The layout that a run with these settings needs. with_baro, with_mag: whether the recording has such samples.
[[nodiscard]] Layout make_layout(const Settings& settings, bool with_baro, bool with_mag);

}  // namespace schuler::fusion
