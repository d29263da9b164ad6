#include "schuler/filter/update/separate.h"

#include <cmath>

namespace schuler::filter {

VerticalGains vertical_gains(double tau) {
    // Errors h, v, a of height, velocity and the correction of the acceleration: h' = v - k1 h, v' = c h - k2 h - a, a' = k3 h, with
    // c = 2 g / R. (s + 1/tau)^3 = s^3 + k1 s^2 + (k2 - c) s + k3.
    constexpr double g = 9.80665, radius = 6371000.0;
    return {3.0 / tau, 3.0 / (tau * tau) + 2.0 * g / radius, 1.0 / (tau * tau * tau)};
}

double correction_share(double dt, double tau) { return -std::expm1(-dt / tau); }

Gains setting_gains(Eigen::Index states, const Measurement& local, int first, double share) {
    Gains K = Gains::Zero(states, 3);
    for (int i = 0; i < local.dof; ++i) {
        const estim::Row& row = local.rows[static_cast<std::size_t>(i)];
        for (int axis = 0; axis < 3; ++axis)
            if (row.head(first + axis) != 0.0) K(first + axis, i) = share / row.head(first + axis);
    }
    return K;
}

Gains barometer_gains(Eigen::Index states, const Eigen::Matrix3d& C_nb, double dt, double tau) {
    const VerticalGains g = vertical_gains(tau);
    Gains K = Gains::Zero(states, 3);
    K(Layout::position + 2, 0) = -g.height * dt;
    K(Layout::velocity + 2, 0) = -g.velocity * dt;
    K.block<3, 1>(Layout::accel_bias, 0) = g.acceleration * dt * C_nb.row(2).transpose();
    return K;
}

}  // namespace schuler::filter
