// The backward half of the offline solution: fixed-interval smoothing of both channels, one after the other, so that the
// smoothed tilt is as free of the magnetometer as the filtered one.
#pragma once

#include "schuler/ahrs/run.h"

namespace schuler::ahrs {

/// Forward filter and Bryson-Frazier smoother [Bierman1973] over a log in memory. Needs about 2 kB a filter block.
[[nodiscard]] RunResult run_offline(std::span<const ImuSample> imu, std::span<const MagSample> mag,
                                    std::span<const SpeedSample> speed, const MekfSettings& settings);

}  // namespace schuler::ahrs
