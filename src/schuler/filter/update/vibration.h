// Vibration of an inertial unit: the part of its white noise that varies with engines, rotors and roads.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <algorithm>

namespace schuler::filter {

/// Density of white noise that would produce the differences of successive samples over the last second. Vehicle motion is smooth
/// over two samples and contributes little to their second difference; undersampled vibration does contribute. Plain and copyable.
struct Vibration {
    double gyro_psd = 0.0;   ///< rad^2/s, mean of the axes
    double accel_psd = 0.0;  ///< m^2/s^3

    /// Increments in time order, without interpolated ones.
    void add(const ImuIncrement& inc) {
        constexpr double memory = 1.0;          // s
        constexpr double of_white = 3.0 * 6.0;  // mean square of a second difference of three components
        const Eigen::Vector3d new_rate = inc.dtheta / inc.dt, new_force = inc.dv / inc.dt;
        const Eigen::Vector3d new_rate_step = new_rate - rate, new_force_step = new_force - force;
        ++samples;
        if (samples > 2) {
            const double weight = std::max(inc.dt / memory, 1.0 / (samples - 2.0));
            gyro_psd += weight * ((new_rate_step - rate_step).squaredNorm() * inc.dt / of_white - gyro_psd);
            accel_psd += weight * ((new_force_step - force_step).squaredNorm() * inc.dt / of_white - accel_psd);
        }
        rate = new_rate;
        force = new_force;
        rate_step = new_rate_step;
        force_step = new_force_step;
    }

    double samples = 0.0;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();  ///< last, rad/s, m/s^2
    Eigen::Vector3d rate_step = Eigen::Vector3d::Zero(),
                    force_step = Eigen::Vector3d::Zero();  ///< to the last from the one before
};

}  // namespace schuler::filter
