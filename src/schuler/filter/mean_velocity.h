// The mean of the velocity over a span that ends now, in the errors of now: what a change of phase between its ends measures.
#pragma once

#include "schuler/estim/transition.h"

#include <array>

namespace schuler::filter {

/// Three rows: with the errors x of now, rows . x is the integral of the velocity's error since `begin`, in the filter's own axes. Errors that
/// manoeuvres make of tilt, biases and gains within the span are in them. And the displacement itself, as the estimate of now has it: corrections
/// within the span count as if they had been known from its begin. Plain and copyable.
struct MeanVelocity {
    std::array<estim::StateVector, 3> rows;   ///< m by the states' units
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();   ///< m, Earth-fixed, of the point that moves, at `begin`
    /// m, the filter's own axes: what corrections since `begin` have made of the integral of the velocity's error beyond what they made of the
    /// position's.
    Eigen::Vector3d carried = Eigen::Vector3d::Zero();
    double time = 0.0;                        ///< s since `begin`
    double noise = 0.0;                       ///< m^2: what the sensors' white noise within the span makes of the integral against the rows, an axis

    void begin(Eigen::Index states, const Eigen::Vector3d& from);
    [[nodiscard]] bool begun() const { return rows[0].size() > 0; }
    /// The errors have moved by phi in dt seconds, in which white noise walked velocity (m^2/s^2) and attitude (rad^2) by so much, under the
    /// specific force (m/s^2).
    void follow(const estim::Transition& phi, double dt, double velocity_walk, double attitude_walk, double force);
    /// The estimate is going to be corrected by dx, estimate minus truth.
    void correct(const estim::StateVector& dx) {
        if (begun()) carried += beyond_position(dx);
    }
    /// m, the filter's own axes: the integral of the velocity's error that dx is, less its position's.
    [[nodiscard]] Eigen::Vector3d beyond_position(const estim::StateVector& dx) const {
        return Eigen::Vector3d(rows[0].dot(dx), rows[1].dot(dx), rows[2].dot(dx)) - dx.head<3>();
    }
};

}  // namespace schuler::filter
