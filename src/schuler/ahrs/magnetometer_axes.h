// Which way round a magnetometer is mounted, or its columns are named: found from the way its field turns in the body, which has to be
// the gyro's.
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
    bool swapped = false;       ///< C_bs is another than the identity, beyond doubt
    bool sign_assumed = false;  ///< all three signs together do not show in the turning: the field was taken to point down
    double explained =
        std::numeric_limits<double>::quiet_NaN();  ///< share of the field's changes that the gyro explains, with C_bs
    double as_given = std::numeric_limits<double>::quiet_NaN();  ///< ... and with the axes as they are
};

/// Compares all 24 orders and signs of axes, hard iron taken out of each; the readings negated turn just the same, so of each pair the
/// one is taken whose field points down (`field_down` positive, or NaN: not known), or up (negative). Where the log turns too little,
/// about one axis only, or the readings agree as they are, the identity is kept.
[[nodiscard]] MagnetometerAxes recognise_axes(std::span<const ImuSample> imu, std::span<const MagSample> mag,
                                              double field_down = std::numeric_limits<double>::quiet_NaN());

/// "x = -y, y = x, z = z": body axis = reading.
[[nodiscard]] std::string axes_text(const Eigen::Matrix3d& C_bs);

}  // namespace schuler::ahrs
