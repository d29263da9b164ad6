#include "schuler/gravimetry/resolution.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::gravimetry {

double noise_density(const SensorNoise& noise, const VerticalMotion& motion, double frequency) {
    const double w2 = std::pow(2.0 * std::numbers::pi * frequency, 2);
    const double by_position = motion.sigma_position * motion.sigma_position / motion.rate * w2 * w2;
    const double by_velocity = motion.sigma_velocity * motion.sigma_velocity / motion.rate * w2;
    const double kinematic = std::isfinite(by_velocity) ? by_position * by_velocity / (by_position + by_velocity) : by_position;
    return noise.accel_psd + noise.accel_bias_psd / w2 + kinematic;
}

double disturbance_density(const DisturbanceModel& model, double speed, double frequency) {
    if (model.kind == DisturbanceKind::Constant) return 0.0;
    const double pace = model.by_time ? 1.0 : speed;
    const double k = pace / model.length, w = 2.0 * std::numbers::pi * frequency, variance = std::pow(model.sigma_n.z(), 2);
    if (!(k > 0.0)) return 0.0;
    const double pole = k * k + w * w;
    switch (model.kind) {
        case DisturbanceKind::SecondOrder: return variance * 4.0 * std::pow(k, 3) / std::pow(pole, 2);
        case DisturbanceKind::ThirdOrder: return variance * 16.0 / 3.0 * std::pow(k, 5) / std::pow(pole, 3);
        default: return variance * 2.0 * k / pole;
    }
}

double resolved_period(const SurveySettings& settings, const VerticalMotion& motion) {
    // S decreases and the fixes' part of N increases: the highest frequency with S larger is searched from above.
    for (double period = 2.0; period < 1e6; period *= 1.01) {
        const double f = 1.0 / period;
        if (disturbance_density(settings.disturbance, motion.speed, f) >= noise_density(settings.noise, motion, f)) return period;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace schuler::gravimetry
