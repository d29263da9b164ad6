// User settings for the gravity disturbance: model, prior, injected disturbance.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/gravimetry/model.h"
#include "schuler/sim/anomaly.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::settings {

/// Section [gravity]. Vectors are east, north, up, as in user files.
struct GravityConfig {
    gravimetry::DisturbanceKind model = gravimetry::DisturbanceKind::SecondOrder;
    gravimetry::DisturbanceAxes axes = gravimetry::DisturbanceAxes::LocalLevel;
    double length = 5000.0;   ///< of the random part, m along the track
    double time = not_given;  ///< of the random part, s; if given, the process depends on time
    Eigen::Vector3d sigma_enu{20.0 * units::mgal, 20.0 * units::mgal, 20.0 * units::mgal};  ///< of the random part, m/s^2
    Eigen::Vector3d prior_enu{50.0 * units::mgal, 50.0 * units::mgal, 50.0 * units::mgal};  ///< of the systematic part, m/s^2
    double slope = not_given;          ///< initial slope of a polynomial, m/s^2 per metre (per second if by time)
    double curvature = not_given;      ///< initial second derivative, m/s^2 per square metre (or second)
    double gnss_position = not_given;  ///< systematic error of the fixes, m; not given: gnss.correlated_m
    double gnss_velocity = 0.0;        ///< m/s
    double lowpass = not_given;        ///< of the classical pipeline, s; not given: the resolution of the smoother
    bool smooth = true;
    std::vector<double> steps;             ///< s after the first fix: possible changes of the constant part
    bool height_aid = false;               ///< also use a barometer or depth gauge, with its constant error as a state
    std::vector<sim::AnomalyPart> inject;  ///< added to recorded logs, as if part of gravity
};

}  // namespace schuler::settings
