#include "schuler/theory/requirements.h"

#include "schuler/core/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::theory {

double Pendulum::frequency() const { return std::sqrt(gravity / radius); }

double position_by_accel(const Pendulum& p, double t) {
    const double half = std::sin(0.5 * p.frequency() * t);   // 1 - cos without cancellation
    return 2.0 * half * half * p.radius / p.gravity;
}

double position_by_gyro(const Pendulum& p, double t) {
    const double w = p.frequency(), x = w * t;
    const double difference = x < 0.02 ? x * x * x / 6.0 * (1.0 - x * x / 20.0) : x - std::sin(x);
    return p.radius * difference / w;
}

Requirement requirement(const Pendulum& p, double budget, double outage) {
    const auto check = [](double x, const char* key) {
        if (!(std::isfinite(x) && x > 0.0)) throw input_error("is not positive", {.file = {}, .line = 0, .column = 0, .key = key}, "give a positive number");
    };
    check(budget, "budget");
    check(outage, "outage");
    const double half_period = std::numbers::pi / p.frequency();
    return {budget / position_by_accel(p, std::min(outage, half_period)), budget / position_by_gyro(p, outage)};
}

double position_sigma(const Pendulum& p, const SensorSigmas& s, double t) {
    const double noise_a = s.accel_noise * std::pow(t, 1.5) / std::sqrt(3.0);
    const double noise_g = p.gravity * s.gyro_noise * std::pow(t, 2.5) / std::sqrt(20.0);
    return std::hypot(std::hypot(s.accel_bias * position_by_accel(p, t), s.gyro_bias * position_by_gyro(p, t)), std::hypot(noise_a, noise_g));
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
