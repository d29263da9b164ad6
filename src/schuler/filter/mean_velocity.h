// The mean of the velocity over a span that ends now, in the errors of now: what a change of phase between its ends measures.
#pragma once

#include "schuler/estim/transition.h"

#include <array>

namespace schuler::filter {

/// Three rows: with the errors x of now, rows . x is the integral of the velocity's error since `begin`, in the filter's own axes. Errors that
/// manoeuvres make of tilt, biases and gains within the span are in them. Plain and copyable.
struct MeanVelocity {
    std::array<estim::StateVector, 3> rows;   ///< m by the states' units
    double time = 0.0;                        ///< s since `begin`
    double noise = 0.0;                       ///< m^2: what the sensors' white noise within the span makes of the integral against the rows, an axis

    void begin(Eigen::Index states);
    /// The errors have moved by phi in dt seconds, in which white noise walked velocity (m^2/s^2) and attitude (rad^2) by so much, under the
    /// specific force (m/s^2).
    void follow(const estim::Transition& phi, double dt, double velocity_walk, double attitude_walk, double force);
};

}  // namespace schuler::filter
