// How much a quantity of the motion, the angular rate or the specific force, changes within a short time that is not known exactly.
//
// Its derivative at one instant does not describe it: at the peak of a vibration it is zero, and a hundredth of a second later the quantity has
// the other sign. The mean square of the derivative over the last fifth of a second does; for times longer than the period of a
// vibration, twice the variance of the quantity bounds it.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::filter {

/// Exponential means over `memory` of a quantity with the unit u, axis by axis.
struct RecentChange {
    static constexpr double memory = 0.2;  ///< s

    Eigen::Vector3d mean = Eigen::Vector3d::Zero();               ///< u
    Eigen::Vector3d square = Eigen::Vector3d::Zero();             ///< u^2, mean square
    Eigen::Vector3d derivative_square = Eigen::Vector3d::Zero();  ///< u^2/s^2, mean square of the derivative

    /// value (u) and derivative (u/s) over the last `dt` (s).
    void add(const Eigen::Vector3d& value, const Eigen::Vector3d& derivative, double dt) {
        const double weight = dt / (memory + dt);
        mean += weight * (value - mean);
        square += weight * (value.cwiseAbs2() - square);
        derivative_square += weight * (derivative.cwiseAbs2() - derivative_square);
    }

    /// Mean square change of each axis within a time of mean square `time2` (s^2), beyond that of white noise of the density `psd`
    /// (u^2 s) in samples of `dt` (s); u^2.
    [[nodiscard]] Eigen::Vector3d change_square(double time2, double psd, double dt) const {
        const Eigen::Array3d derivative = derivative_square.array() - 2.0 * psd / (dt * dt * dt);
        const Eigen::Array3d variance = square.array() - mean.array().square() - psd / dt;
        return (time2 * derivative).min(2.0 * variance).max(0.0).matrix();
    }

    /// Frequency of an oscillation with this mean square and that of the derivative, over all axes and beyond the noise, Hz; infinite if
    /// there is none. The mean over `memory` leaves slower motion out.
    [[nodiscard]] double frequency(double psd, double dt) const {
        const Totals all = totals(psd, dt);
        if (!(all.variance > 0.0)) return std::numeric_limits<double>::infinity();
        return std::sqrt(std::max(0.0, all.derivative) / all.variance) / (2.0 * std::numbers::pi);
    }

    /// change_square of the vector as a whole, sum over the axes: less affected by the noise of an axis that hardly changes.
    [[nodiscard]] double total_change_square(double time2, double psd, double dt) const {
        const Totals all = totals(psd, dt);
        return std::max(0.0, std::min(time2 * all.derivative, 2.0 * all.variance));
    }

private:
    /// Sums over the axes beyond the noise: mean square of the derivative, u^2/s^2, and variance, u^2.
    struct Totals {
        double derivative, variance;
    };
    [[nodiscard]] Totals totals(double psd, double dt) const {
        return {derivative_square.sum() - 6.0 * psd / (dt * dt * dt), square.sum() - mean.squaredNorm() - 3.0 * psd / dt};
    }
};

}  // namespace schuler::filter
