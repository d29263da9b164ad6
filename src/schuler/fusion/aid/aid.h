// What every aid shares: the estimate it is compared with, and rows for the largest filter, in local-level errors.
//
// An aid is one pure function from an estimate and a sample to innovation, rows and variances. Rows refer to
// (position, velocity, attitude) errors in north-east-down whatever the mechanization; the filter maps them.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"
#include "schuler/fusion/inertial_filter.h"
#include "schuler/fusion/layout.h"

#include <Eigen/Core>

namespace schuler::fusion {

inline constexpr int max_states = 44;

/// The estimate as aids see it.
struct Estimate {
    earth::Earth earth;
    Layout layout;
    NavState nav;
    Eigen::Matrix3d C_nb;
    Eigen::Vector3d w_ib_b;                              ///< rad/s, corrected for the gyro errors
    Eigen::Matrix<double, max_states, 1> parameters;     ///< nominal values of the states from 9 on
};

/// Rows in local-level errors.
using LocalMeasurement = Measurement<max_states>;

/// Appends one component: the caller fills the returned row.
[[nodiscard]] inline int add_component(LocalMeasurement& m, double innovation, double variance) {
    m.innovation(m.dof) = innovation;
    m.variance(m.dof) = variance;
    return m.dof++;
}

}  // namespace schuler::fusion
