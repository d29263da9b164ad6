// Resolution of a smoother along a track, from spectra alone.
#pragma once

#include "schuler/gravimetry/settings.h"

namespace schuler::gravimetry {

/// White errors of the measured vertical motion, fix rate and speed.
struct VerticalMotion {
    double sigma_position = 0.05;  ///< of a fix, down, m
    double sigma_velocity = 0.05;  ///< m/s; infinite: not measured
    double rate = 1.0;             ///< fixes per second
    double speed = 0.0;            ///< m/s
};

/// Two-sided density of the error of a gravity value from accelerometer and fixes at a frequency (Hz), m^2/s^3: the
/// accelerometer's white noise and the kinematic acceleration from position and velocity together.
[[nodiscard]] double noise_density(const SensorNoise& noise, const VerticalMotion& motion, double frequency);

/// Two-sided density of the random part of the disturbance (down) at a given speed, m^2/s^3. Zero for a constant.
[[nodiscard]] double disturbance_density(const DisturbanceModel& model, double speed, double frequency);

/// Period (s) of a harmonic that the fixed-interval smoother, a Wiener filter of gain S/(S + N), passes at half its amplitude;
/// NaN if the model has no random part, or the gain is below one half everywhere.
[[nodiscard]] double resolved_period(const SurveySettings& settings, const VerticalMotion& motion);

}  // namespace schuler::gravimetry
