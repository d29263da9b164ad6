// Shared by all measurements: the estimate they are compared with, and rows in local-level errors.
//
// A measurement is one pure function from an estimate and a sample to innovation, rows and variances. Rows refer to
// (position, velocity, attitude) errors in north-east-down for both mechanizations; the filter transforms them.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"
#include "schuler/estim/update.h"
#include "schuler/filter/states/layout.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>

namespace schuler::filter {

/// The estimate as used by measurements.
struct Estimate {
    earth::Earth earth;
    Layout layout;
    NavState nav;
    Eigen::Matrix3d C_nb;
    Eigen::Vector3d w_ib_b;                                          ///< rad/s, corrected for the gyro errors
    Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  ///< rad/s^2, body axes; 0 without a lever arm or a latency
    double rate_variance = 0.0;    ///< rad^2/s^2, InertialFilter::rate_variance of it; 0 without a lever arm
    double uncertain_rate = 0.0;   ///< rad/s: InertialFilter::uncertain_rate of it; likewise
    double heading_unknown = 0.0;  ///< from 0 to 1 (heading_force.h)
    Eigen::Matrix2d tilt_covariance = Eigen::Matrix2d::Zero();  ///< rad^2, north and east; 0 without a magnetometer
    Eigen::Vector3d a_n =
        Eigen::Vector3d::Zero();    ///< m/s^2, mean acceleration over the most recent interval, without the Coriolis contribution
    estim::StateVector parameters;  ///< nominal values of the states from 9 on
};

/// Angular rate of the body relative to the Earth, body axes, rad/s.
[[nodiscard]] inline Eigen::Vector3d rate_to_earth(const Estimate& e) {
    return e.w_ib_b - e.C_nb.transpose() * earth::terms_at(e.earth, e.nav.position, e.nav.v_eb_n).w_ie_n;
}

/// A measurement of up to three components with independent noise.
/// innovation = computed minus measured = row . error + noise (error = estimate minus truth).
struct Measurement {
    int dof = 0;
    std::array<estim::Row, 3> rows;
    Eigen::Vector3d innovation = Eigen::Vector3d::Zero();
    Eigen::Vector3d variance = Eigen::Vector3d::Ones();

    /// Appends a component; the caller fills its row.
    estim::Row& add(double innovation_, double variance_) {
        innovation(dof) = innovation_;
        variance(dof) = variance_;
        return rows[static_cast<std::size_t>(dof++)];
    }
};

/// The head of a row split into its position, velocity and attitude parts.
inline auto position_of(estim::Row& row) { return row.head.segment<3>(Layout::position); }
inline auto velocity_of(estim::Row& row) { return row.head.segment<3>(Layout::velocity); }
inline auto attitude_of(estim::Row& row) { return row.head.segment<3>(Layout::attitude); }

}  // namespace schuler::filter
