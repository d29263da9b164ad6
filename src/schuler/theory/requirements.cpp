#include "schuler/theory/requirements.h"

#include "schuler/core/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::theory {

Requirement requirement(const Pendulum& p, double budget, double outage) {
    const auto check = [](double x, const char* key) {
        if (!(std::isfinite(x) && x > 0.0))
            throw input_error("is not positive", {.file = {}, .line = 0, .column = 0, .key = key}, "give a positive number");
    };
    check(budget, "budget");
    check(outage, "outage");
    const double half_period = std::numbers::pi / p.frequency();
    return {budget / p.from_accelerometer(1.0, std::min(outage, half_period)), budget / p.from_gyro(1.0, outage)};
}

double position_sigma(const Pendulum& p, const SensorSigmas& s, double t) {
    const double noise_a = s.accel_noise * std::pow(t, 1.5) / std::sqrt(3.0);
    const double noise_g = p.g * s.gyro_noise * std::pow(t, 2.5) / std::sqrt(20.0);
    return std::hypot(std::hypot(p.from_accelerometer(s.accel_bias, t), p.from_gyro(s.gyro_bias, t)),
                      std::hypot(noise_a, noise_g));
}

double longest_outage(const Pendulum& p, const SensorSigmas& s, double budget, double longest) {
    double low = 0.0, high = 1.0;
    while (high < longest && position_sigma(p, s, high) <= budget) {
        low = high;
        high = std::min(longest, 1.05 * high);
    }
    if (position_sigma(p, s, high) <= budget) return longest;
    while (high - low > 1e-9 * high) {
        const double middle = 0.5 * (low + high);
        (position_sigma(p, s, middle) <= budget ? low : high) = middle;
    }
    return low;
}

}  // namespace schuler::theory
