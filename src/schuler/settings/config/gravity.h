// What a user can set about the disturbance of gravity: its model, its prior, what is injected.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/gravimetry/model.h"
#include "schuler/sim/anomaly.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::settings {

/// Section [gravity]. Vectors are east, north, up, as a user writes them.
struct GravityConfig {
    gravimetry::DisturbanceKind model = gravimetry::DisturbanceKind::SecondOrder;
    gravimetry::DisturbanceAxes axes = gravimetry::DisturbanceAxes::LocalLevel;
    double length = 5000.0;   ///< of the random part, m along the track
    double time = not_given;  ///< of the random part, s; given: it runs by time
    Eigen::Vector3d sigma_enu{20.0 * units::mgal, 20.0 * units::mgal, 20.0 * units::mgal};  ///< of the random part, m/s^2
    Eigen::Vector3d prior_enu{50.0 * units::mgal, 50.0 * units::mgal, 50.0 * units::mgal};  ///< of the systematic part, m/s^2
    double slope = not_given;          ///< of a polynomial at the start, m/s^2 per metre (per second where it runs by time)
    double curvature = not_given;      ///< its second derivative there, m/s^2 per square metre (or second)
    double gnss_position = not_given;  ///< systematic error of the fixes, m; not given: gnss.correlated_m
    double gnss_velocity = 0.0;        ///< m/s
    double lowpass = not_given;        ///< of the classical pipeline, s; not given: as the smoother resolves
    bool smooth = true;
    std::vector<double> steps;             ///< s after the first fix: the constant part may have changed there
    bool height_aid = false;               ///< a barometer or depth gauge is taken too, its constant error a state
    std::vector<sim::AnomalyPart> inject;  ///< into recorded logs, as if gravity had it
};

}  // namespace schuler::settings
