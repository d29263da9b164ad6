// Gains of the uncoupled scheme: the mechanization is reset to the receiver; its errors are not estimated.
#pragma once

#include "schuler/filter/settings.h"
#include "schuler/filter/states/inertial_filter.h"

namespace schuler::filter {

/// Gains of the barometric loop on height, vertical velocity and vertical acceleration: three equal real roots of time constant
/// tau against the instability 2g/R of the unaided channel. [PaperA:1.4]; derived in docs/complex.md
struct VerticalGains {
    double height;        ///< 1/s
    double velocity;      ///< 1/s^2
    double acceleration;  ///< 1/s^3
};
[[nodiscard]] VerticalGains vertical_gains(double tau);

/// Fraction of a difference corrected in dt seconds by a continuous correction with time constant tau.
[[nodiscard]] double correction_share(double dt, double tau);

/// Gain columns of the components of a measurement.
using Gains = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, estim::max_states, 3>;

/// Gain columns in local-level errors for the components of a measurement: each corrects the state measured by its row by
/// `share`. first: of the position or velocity block.
[[nodiscard]] Gains setting_gains(Eigen::Index states, const Measurement& local, int first, double share);

/// Gain column of a barometric height (row: -1 for the down position) after dt seconds.
[[nodiscard]] Gains barometer_gains(Eigen::Index states, const Eigen::Matrix3d& C_nb, double dt, double tau);

}  // namespace schuler::filter
