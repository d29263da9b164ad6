// Clock of a magnetometer against that of the IMU beside it: by which shift of its times its field turns with the gyro.
#pragma once

#include "schuler/core/samples.h"

#include <limits>
#include <span>

namespace schuler::ahrs {

struct MagnetometerClock {
    double delay = 0.0;  ///< s, age of a reading at its time; 0: none was found beyond doubt
    double explained =
        std::numeric_limits<double>::quiet_NaN();  ///< fraction of the field's changes explained by the gyro, with the delay
    double as_given = std::numeric_limits<double>::quiet_NaN();  ///< ... and with the times as given
};

/// Compares delays of up to half a second either way, where needed with all 24 orders and signs of the axes; of the delays up to
/// 1.2 s no other may explain the changes as well. Delays of less than 0.03 s are left to the heading channel, which estimates them.
[[nodiscard]] MagnetometerClock find_delay(std::span<const ImuSample> imu, std::span<const MagSample> mag);

}  // namespace schuler::ahrs
