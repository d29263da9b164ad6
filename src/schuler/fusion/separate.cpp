#include "schuler/fusion/separate.h"

#include <cmath>

namespace schuler::fusion {

VerticalGains vertical_gains(double tau) {
    // Errors h, v, a of height, velocity and the correction of the acceleration: h' = v - k1 h, v' = c h - k2 h - a, a' = k3 h, with
    // c = 2 g / R. (s + 1/tau)^3 = s^3 + k1 s^2 + (k2 - c) s + k3.
    constexpr double g = 9.80665, radius = 6371000.0;
    return {3.0 / tau, 3.0 / (tau * tau) + 2.0 * g / radius, 1.0 / (tau * tau * tau)};
}

double correction_share(double dt, double tau) { return -std::expm1(-dt / tau); }

}  // namespace schuler::fusion
