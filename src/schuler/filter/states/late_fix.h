// What corrections of the velocity mean for positions that are late.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/filter/states/layout.h"

#include <Eigen/Core>

namespace schuler::filter {

/// Corrections of velocity and latency since the last propagation of the covariance. A late fix gives the position of an instant before,
/// p - latency v; the covariance keeps what is known of that one. Otherwise corrections of the velocity, which are noise, would be taken
/// for motion and show a latency that only an acceleration can show (docs/found.md).
struct LateFix {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s, frame axes
    double latency = 0.0;                                ///< s

    /// dx: error subtracted from the estimate.
    void correct(const Layout& layout, const estim::StateVector& dx) {
        if (layout.gnss_latency < 0) return;
        velocity -= dx.segment<3>(Layout::velocity);
        latency -= dx(layout.gnss_latency);
    }
    /// To first order, the error of p changes by the corrections of v and latency times the error of the other: rows of position of the
    /// transition (Layout::driven() includes the latency), and the same for an error x.
    void fill(const Layout& layout, estim::Transition& phi) const {
        if (layout.gnss_latency < 0) return;
        for (int i = 0; i < 3; ++i) {
            phi.rows(layout.gnss_latency, Layout::position + i) += velocity(i);
            phi.rows(Layout::velocity + i, Layout::position + i) += latency;
        }
    }
    [[nodiscard]] estim::StateVector shift(const Layout& layout, const estim::StateVector& x) const {
        estim::StateVector out = estim::StateVector::Zero(x.size());
        if (layout.gnss_latency >= 0)
            out.segment<3>(Layout::position) = velocity * x(layout.gnss_latency) + latency * x.segment<3>(Layout::velocity);
        return out;
    }
};

}  // namespace schuler::filter
