// What corrections of the estimate mean for measurements that do not see the estimated position itself.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/filter/states/layout.h"

#include <Eigen/Core>

namespace schuler::filter {

/// Corrections since the last propagation of the covariance. The covariance keeps what is known of what the fixes give:
/// - of the antenna, so that a correction of the heading is no information on it;
/// - of the position of an instant before, p - latency v, which a late fix gives. Otherwise corrections of the velocity, which are
///   noise, would be taken for motion and show a latency that only an acceleration can show (docs/found.md).
/// They are parts of the transition of the covariance, not of an estimated error, which they leave as it is.
struct Corrections {
    Eigen::Vector3d antenna_moved = Eigen::Vector3d::Zero();  ///< m, frame axes: about the unit, by corrections of the attitude
    Eigen::Matrix3d arm_turned = Eigen::Matrix3d::Zero();     ///< the same of the row of the lever arm, if it is a state
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();       ///< m/s, frame axes; with a latency as a state
    double latency = 0.0;                                     ///< s, likewise

    /// dx: error subtracted from the estimate.
    void add_late(const Layout& layout, const estim::StateVector& dx) {
        if (layout.gnss_latency < 0) return;
        velocity -= dx.segment<3>(Layout::velocity);
        latency -= dx(layout.gnss_latency);
    }
    /// To first order, the error of p changes by the corrections of v and latency times the error of the other (Layout::driven()
    /// includes the latency).
    void fill_late(const Layout& layout, estim::Transition& phi) const {
        if (layout.gnss_latency < 0) return;
        for (int i = 0; i < 3; ++i) {
            phi.rows(layout.gnss_latency, Layout::position + i) += velocity(i);
            phi.rows(Layout::velocity + i, Layout::position + i) += latency;
        }
    }
};

}  // namespace schuler::filter
