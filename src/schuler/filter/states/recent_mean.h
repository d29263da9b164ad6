// Slope of the motion for a measurement whose time is uncertain.
//
// Within a time that is known to some sigma, a velocity does not change by its derivative at one instant times the error: under a
// vibration whose period is shorter than the sigma, that derivative does not describe the change, and a regression on it finds a latency
// nearer zero than the true one, with a sigma that is too small. Statistical linearization [Gelb1974, section 6.2]: for a Gaussian time t
// of sigma s, the best slope is the expected one, E[t f(t)] / s^2 = E[f'(t)], the derivative averaged with a Gaussian of the width s.
// Four equal lags in series have nearly that weight, but it lies in the past.
#pragma once

#include "schuler/math/triple.h"

#include <Eigen/Core>

#include <array>
#include <cmath>

namespace schuler::filter {

/// Weighted mean of a quantity with the unit u over the immediate past, and its derivative.
struct RecentMean {
    static constexpr int stages = 4;

    std::array<Eigen::Vector3d, stages> lags;  ///< u
    double lag = 0.0;                          ///< s, time constant of each; 0: no value so far

    RecentMean() { reset(Eigen::Vector3d::Zero()); }
    void reset(const Eigen::Vector3d& value) { lags.fill(value); }

    /// value (u) over the last `dt` (s); `width`: standard deviation of the weight over time, s. Its mean is two widths old.
    void add(const math::Triple& value, double dt, double width) {
        if (lag == 0.0 && lags[0].isZero(0.0)) reset(value.vector());
        lag = width / std::sqrt(static_cast<double>(stages));
        const double weight = dt / (lag + dt);
        math::Triple input = value;
        for (Eigen::Vector3d& stage : lags) {
            const math::Triple old(stage);
            input = old + weight * (input - old);
            stage = input.vector();
        }
    }

    [[nodiscard]] const Eigen::Vector3d& mean() const { return lags.back(); }
    /// Derivative of the mean, u/s.
    [[nodiscard]] Eigen::Vector3d derivative() const {
        if (lag == 0.0) return Eigen::Vector3d::Zero();
        return (lags[stages - 2] - lags[stages - 1]) / lag;
    }
};

}  // namespace schuler::filter
