// Settings found from the data: latencies, GNSS and IMU noise, by the likelihood of the innovations (prediction-error method).
#pragma once

#include "schuler/fusion/gnss_faults.h"
#include "schuler/fusion/run_pass.h"

namespace schuler::fusion {

/// Noise of each fix: the log's sigma (raised to the floor), or the scaled default where the log has none; counts the missing ones.
[[nodiscard]] std::vector<FixNoise> fix_noise(const Recording& recording, const GnssSettings& settings, WarningLog& warnings);

/// A value that was found, in the six digits of `unit` that settings files have of it: what is written repeats the run.
[[nodiscard]] double as_written(double si, double unit);

/// True where the log leaves out standard deviations of positions or of velocities.
struct MissingStd {
    bool position = false, velocity = false;
};
[[nodiscard]] MissingStd missing_std(const Recording& recording);

/// Adjusts in place the settings that are to be estimated (gnss.latency and the channels', default sigmas, IMU noise): each by a
/// one-dimensional search on the log-likelihood of the GNSS innovations of a trial run over at most ten minutes. `data` is
/// brought up to date with the result. Withheld epochs take no part, nor does what `screen` leaves out.
void tune(RunData& data, Settings& settings, const Start& start, const FixScreen& screen, Findings& findings,
          WarningLog& warnings);

}  // namespace schuler::fusion
