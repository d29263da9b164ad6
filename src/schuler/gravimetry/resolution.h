// What a smoother can resolve along a track, from spectra alone.
#pragma once

#include "schuler/gravimetry/settings.h"

namespace schuler::gravimetry {

/// White errors of what is known of the vertical motion, and how often and how fast.
struct VerticalMotion {
    double sigma_position = 0.05;  ///< of a fix, down, m
    double sigma_velocity = 0.05;  ///< m/s; infinite: not measured
    double rate = 1.0;             ///< fixes a second
    double speed = 0.0;            ///< m/s
};

/// Two-sided density of the error of a gravity value that accelerometer and fixes give at a frequency (Hz), m^2/s^3: the
/// accelerometer's white noise and the kinematic acceleration of position and velocity together.
[[nodiscard]] double noise_density(const SensorNoise& noise, const VerticalMotion& motion, double frequency);

/// Two-sided density of the random part of the disturbance (down), seen at a speed, m^2/s^3. Zero for a constant.
[[nodiscard]] double disturbance_density(const DisturbanceModel& model, double speed, double frequency);

/// Period (s) of a harmonic that the fixed-interval smoother, a Wiener filter of gain S/(S + N), passes at half its amplitude;
/// NaN where the model has no random part, or passes less than half of everything.
[[nodiscard]] double resolved_period(const SurveySettings& settings, const VerticalMotion& motion);

}  // namespace schuler::gravimetry
