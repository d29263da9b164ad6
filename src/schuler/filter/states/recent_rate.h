// How much the angular rate changes within a short time that is not known exactly.
//
// The rate at one instant does not tell: at the peak of a vibration it does not change at all, and a hundredth of a second later it has
// the other sign. The mean square of the angular acceleration over the last fifth of a second does; for times longer than the period
// of a vibration, twice the variance of the rate bounds it.
#pragma once

#include <Eigen/Core>

#include <algorithm>

namespace schuler::filter {

/// Exponential means over `memory`. Vectors in the axes of the body.
struct RecentRate {
    static constexpr double memory = 0.2;  ///< s

    Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< rad/s
    double square = 0.0;                             ///< rad^2/s^2, mean square of the rate
    double acceleration_square = 0.0;                ///< rad^2/s^4, mean square of the angular acceleration

    /// rate (rad/s) and angular acceleration (rad/s^2) over the last `dt` (s).
    void add(const Eigen::Vector3d& rate, const Eigen::Vector3d& acceleration, double dt) {
        const double weight = dt / (memory + dt);
        mean += weight * (rate - mean);
        square += weight * (rate.squaredNorm() - square);
        acceleration_square += weight * (acceleration.squaredNorm() - acceleration_square);
    }

    /// Sum over the axes of the mean square change within a time of mean square `time2` (s^2), beyond that of white noise of the
    /// density `psd` (rad^2/s) in samples of `dt` (s); rad^2/s^2.
    [[nodiscard]] double change_square(double time2, double psd, double dt) const {
        const double acceleration = acceleration_square - 6.0 * psd / (dt * dt * dt);
        const double variance = square - mean.squaredNorm() - 3.0 * psd / dt;
        return std::max(0.0, std::min(time2 * acceleration, 2.0 * variance));
    }
};

}  // namespace schuler::filter
