// Three-axis instruments calibrated from the log itself: readings of a field of constant size lie on an ellipsoid.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

namespace schuler::ahrs {

/// true = gain * (measured - offset). The gain is symmetric: a rotation of the instrument's axes does not show in the size.
struct EllipsoidFit {
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();
    double size = 0.0;                   ///< of the field, in the unit of the readings
    double residual = 0.0;               ///< one sigma of the calibrated size, same unit
    std::size_t samples = 0;

    [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& measured) const { return gain * (measured - offset); }
};

/// Least squares for the quadric through the readings, outliers left out in a second pass. `size`: the true size of the
/// field; not positive: the mean size of the readings less the offset is kept. Nothing where the readings cover too few
/// directions (fewer than 12 of 26 equal parts of the sphere), or do not lie on an ellipsoid.
[[nodiscard]] std::optional<EllipsoidFit> fit_ellipsoid(std::span<const Eigen::Vector3d> readings, double size);

/// Mean specific force (m/s^2) of each stretch of 0.5 s in which neither instrument moves: readings of gravity for fit_ellipsoid.
[[nodiscard]] std::vector<Eigen::Vector3d> still_forces(std::span<const ImuSample> imu);

}  // namespace schuler::ahrs
