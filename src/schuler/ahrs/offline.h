// The offline solution: fixed-interval smoothing of both channels, one after the other, so that the smoothed tilt is as free of the
// magnetometer as the filtered one. The heading is smoothed several times: each pass weighs the magnetometer's samples by what the
// smoothed states of the pass before have left of them, past and future alike, where the filter knows only the innovation.
#pragma once

#include "schuler/ahrs/run.h"

namespace schuler::ahrs {

/// Forward filter and Bryson-Frazier smoother [Bierman1973] over a log in memory. Needs about 2 kB a filter block (50 ms).
[[nodiscard]] RunResult run_offline(std::span<const ImuSample> imu, std::span<const MagSample> mag,
                                    std::span<const SpeedSample> speed, const MekfSettings& settings);

}  // namespace schuler::ahrs
