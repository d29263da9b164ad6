// Mounting orientation of a magnetometer, or assignment of its columns: determined from the rotation of its field in the body,
// which must agree with the gyro's.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <limits>
#include <span>
#include <string>

namespace schuler::ahrs {

struct MagnetometerAxes {
    /// field_b = C_bs * reading; every row and column has one entry, 1 or -1. Determinant -1: the readings are left-handed.
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();
    bool swapped = false;       ///< C_bs differs from the identity beyond doubt
    bool sign_assumed = false;  ///< a common sign of all axes is not determined by rotation: the field was assumed to point down
    double explained =
        std::numeric_limits<double>::quiet_NaN();  ///< fraction of the field's changes explained by the gyro, with C_bs
    double as_given = std::numeric_limits<double>::quiet_NaN();  ///< ... and with the axes as given
};

/// Compares all 24 permutations and signs of axes, each with hard iron removed; the negated readings rotate identically, so of
/// each pair the one whose field points down is chosen (`field_down` positive, or NaN: unknown), or up (negative). If the log
/// contains too little rotation, or about one axis only, or the readings agree as they are, the identity is kept.
[[nodiscard]] MagnetometerAxes recognise_axes(std::span<const ImuSample> imu, std::span<const MagSample> mag,
                                              double field_down = std::numeric_limits<double>::quiet_NaN());

/// "x = -y, y = x, z = z": body axis = reading.
[[nodiscard]] std::string axes_text(const Eigen::Matrix3d& C_bs);

}  // namespace schuler::ahrs
