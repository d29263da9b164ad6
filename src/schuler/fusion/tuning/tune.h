// Settings estimated from the data: latencies, GNSS and IMU noise, by the innovation likelihood (prediction-error method).
#pragma once

#include "schuler/fusion/faults/gnss_faults.h"
#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Noise of each fix: the log's sigma (raised to the floor), or the scaled default if the log has none; counts the missing ones.
[[nodiscard]] std::vector<FixNoise> fix_noise(const Recording& recording, const GnssSettings& settings, WarningLog& warnings);

/// An estimated value rounded to the six digits of `unit` used in settings files, so that the written value repeats the run.
[[nodiscard]] double as_written(double si, double unit);

/// True if the log lacks standard deviations of positions or of velocities.
struct MissingStd {
    bool position = false, velocity = false;
};
[[nodiscard]] MissingStd missing_std(const Recording& recording);

/// Adjusts in place the settings to be estimated (gnss.latency and those of the channels, default sigmas, IMU noise): each by a
/// one-dimensional search on the log-likelihood of the GNSS innovations of a trial run over at most ten minutes. `data` is
/// updated with the result. Withheld epochs and those excluded by `screen` are not used.
void tune(RunData& data, Settings& settings, const Start& start, const FixScreen& screen, Findings& findings,
          WarningLog& warnings);

}  // namespace schuler::fusion
