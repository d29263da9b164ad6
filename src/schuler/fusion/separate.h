// Gains of the separate scheme: the inertial computation is set to the receiver, not estimated.
#pragma once

#include "schuler/fusion/inertial_filter.h"
#include "schuler/fusion/settings.h"

namespace schuler::fusion {

/// Gains of the barometer's loop on height, vertical velocity and vertical acceleration: three equal real roots of time constant
/// tau against the instability 2g/R of the free channel. [PaperA:1.4]; derived in docs/complex.md
struct VerticalGains {
    double height;         ///< 1/s
    double velocity;       ///< 1/s^2
    double acceleration;   ///< 1/s^3
};
[[nodiscard]] VerticalGains vertical_gains(double tau);

/// Share of a difference that a continuous correction with time constant tau takes in dt seconds.
[[nodiscard]] double correction_share(double dt, double tau);

/// Gain columns in local-level errors for the components of a measurement: each corrects the state that its row measures by
/// `share`. first: of the position's or the velocity's block.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, 3> setting_gains(const Measurement<N>& local, int first, double share) {
    Eigen::Matrix<double, N, 3> K = Eigen::Matrix<double, N, 3>::Zero();
    for (int i = 0; i < local.dof; ++i)
        for (int axis = 0; axis < 3; ++axis)
            if (local.rows(first + axis, i) != 0.0) K(first + axis, i) = share / local.rows(first + axis, i);
    return K;
}

/// Gain column of a barometric height (row: -1 of the down position) after dt seconds.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, 3> barometer_gains(const Eigen::Matrix3d& C_nb, double dt, double tau) {
    const VerticalGains g = vertical_gains(tau);
    Eigen::Matrix<double, N, 3> K = Eigen::Matrix<double, N, 3>::Zero();
    K(Layout::position + 2, 0) = -g.height * dt;
    K(Layout::velocity + 2, 0) = -g.velocity * dt;
    K.template block<3, 1>(Layout::accel_bias, 0) = g.acceleration * dt * C_nb.row(2).transpose();
    return K;
}

}  // namespace schuler::fusion
