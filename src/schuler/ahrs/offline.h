// The offline solution: fixed-interval smoothing of both channels in sequence, so that the smoothed tilt is as independent of the
// magnetometer as the filtered one. The heading is smoothed several times: each pass weights the magnetometer samples by the
// residuals of the previous pass's smoothed states, past and future, while the filter has only the innovation.
#pragma once

#include "schuler/ahrs/run.h"

namespace schuler::ahrs {

/// Forward filter and Bryson-Frazier smoother [Bierman1973] over a log in memory. Requires about 2 kB per filter block (50 ms).
[[nodiscard]] RunResult run_offline(std::span<const ImuSample> imu, std::span<const MagSample> mag,
                                    std::span<const SpeedSample> speed, const MekfSettings& settings);

}  // namespace schuler::ahrs
