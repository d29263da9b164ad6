// Settings of the attitude filters. One set of defaults serves every hand-held or vehicle log; SI units and radians.
#pragma once

#include "schuler/core/units.h"

#include <Eigen/Core>

#include <initializer_list>
#include <limits>
#include <utility>

namespace schuler::ahrs {

/// Criteria for unusable samples. Samples that are not finite are always excluded.
struct GuardSettings {
    static constexpr double unlimited = std::numeric_limits<double>::infinity();
    Eigen::Vector3d gyro_range = Eigen::Vector3d::Constant(unlimited);   ///< rad/s; a component at or beyond it is saturated
    Eigen::Vector3d accel_range = Eigen::Vector3d::Constant(unlimited);  ///< m/s^2
    Eigen::Vector3d field_range = Eigen::Vector3d::Constant(unlimited);  ///< T
    int stuck_after = 25;       ///< this number of identical consecutive samples indicates a frozen instrument
    double longest_step = 0.5;  ///< s; a longer interval between samples is a gap with unknown rotation
    double gap_factor = 3.0;    ///< an interval of more than this many usual ones is a gap whose rotation is interpolated
};

struct RestSettings {
    double rate_change = 1.0 * units::deg_per_s;   ///< rad/s, largest departure of a block's mean rate from its running mean
    double force_change = 0.15;                    ///< m/s^2, likewise of the specific force
    double largest_rate = 3.0 * units::deg_per_s;  ///< rad/s, a constant rate above this is not rest
    double after = 1.5;                            ///< s of calm before rest is declared
    double memory = 0.5;                           ///< s, of the running means
};

/// Tilt channel: gyro and accelerometer.
struct TiltSettings {
    double gyro_noise = 0.02 * units::deg;          ///< rad/sqrt(s)
    double turn_noise = 0.005;                      ///< rad per square root of the rotation in rad: scale factor, axes, coning
    double bias_std = 0.5 * units::deg_per_s;       ///< rad/s, initial
    double bias_walk = 1e-4;                        ///< rad/s/sqrt(s)
    double accel_bias_std = 0.05;                   ///< m/s^2, with scale factors and misalignments: considered, not estimated
    double velocity_std = 0.3;                      ///< m/s, of the velocity changes that the tilt must not follow
    double velocity_time = 0.3;                     ///< s, their correlation time
    double force_noise = 0.02;                      ///< m/s/sqrt(s), uncorrelated accelerations
    double adaptation_time = 3.0;                   ///< s, memory of the level of linear acceleration
    double rest_rate_std = 0.3 * units::deg_per_s;  ///< rad/s, a block's mean rate at rest as a measurement of the bias
    double rest_velocity_std = 0.02;                ///< m/s
    double slip_std = 0.3;                          ///< m/s, forward speed as the total velocity (centripetal correction)
    double gravity = 9.81;                          ///< m/s^2
};

/// Heading channel: magnetometer, on top of the tilt channel, which it cannot affect.
struct HeadingSettings {
    double block = 0.25;              ///< s between updates
    double turn_noise = 0.005;        ///< rad per square root of the rotation in rad
    double gyro_matrix_std = 0.005;   ///< of the gyro's scale factors and misalignments, initial
    double soft_iron_std = 0.03;      ///< of the magnetometer's, initial
    double walk = 0.02 * units::deg;  ///< rad/sqrt(s)
    double field_noise = 2e-6;        ///< T, of the field from place to place
    double field_time = 1.2;          ///< s, its correlation time in motion
    double hard_iron_std = 2e-6;      ///< T, initial
    double magnet_std = 30e-6;        ///< T, of a possible magnet on the sensor
    double hard_iron_walk = 1e-8;     ///< T/sqrt(s)
    double field_walk = 5e-8;         ///< T/sqrt(s)
    double delay_std = 0.015;         ///< s, age of the magnetometer samples, initial
    double delay_walk = 1e-5;         ///< s/sqrt(s)
    double adaptation_time = 1.0;     ///< s, memory of the level of disturbance
    double robustness = 2.0;          ///< the variance grows with this power of the normalised disturbance
    double rest_factor = 30.0;        ///< a stationary sensor measures the same local field repeatedly: variance times this
    double place_std = 2e-6;          ///< T, contribution of a room to the field, which does not average out there
    double place_time = 3600.0;       ///< s, duration of a stay in one room
    double declination = 0.0;         ///< rad, east positive
    Eigen::Vector3d known_field_n =
        Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  ///< T, NED, from a model
    double known_field_std = 3e-6;  ///< T, of that model at this location and of the instrument's scale
};

/// @throws Error(Input) that names the first value that is not positive or not finite.
void check_positive(std::initializer_list<std::pair<const char*, double>> settings);

struct MekfSettings {
    double block = 0.05;    ///< s between filter updates; the strapdown runs at the sensor's rate
    bool six_axis = false;  ///< ignore the magnetometer: heading starts at zero
    GuardSettings guard;
    RestSettings rest;
    TiltSettings tilt;
    HeadingSettings heading;

    /// @throws Error(Input) that names the setting that is not positive or not finite.
    void check() const;
};

}  // namespace schuler::ahrs
