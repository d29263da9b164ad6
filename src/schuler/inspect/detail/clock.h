// IMU against GNSS time by the motion that both logs show: no attitude, units or biases needed.
#pragma once

#include "schuler/inspect/detail/motion.h"
#include "schuler/inspect/detail/motion_fit.h"

#include <optional>
#include <string>
#include <vector>

namespace schuler::inspect::detail {

/// s: how early or late the fixes of a receiver may seem beside the IMU without a clock being wrong, and the middle of it.
inline constexpr double earliest_lag = -0.2, latest_lag = 1.2, middle_lag = 0.4;

/// How well the logs agree where the IMU's times are later by `shift`.
struct ClockPeak {
    double shift = 0.0;        ///< s
    double support = 0.0;      ///< log of the likelihood ratio against no relation
    double correlation = 0.0;  ///< of the channel that says most
};

/// The agreement of two logs at every shift that leaves them 10 s in common.
struct ClockScan {
    std::vector<ClockPeak> peaks;  ///< local maxima, the best first
    double stated = 0.0;           ///< support of the times as they are, within the lags of a receiver; 0 without time in common
    double width = 0.0;            ///< s: peaks nearer to each other are one
};

/// Correlates, over all shifts, the rate about the vertical with the rate of the course, the size of the specific force with that of the track's
/// acceleration less gravity, and the force across the mean vertical with the horizontal acceleration. The number of independent
/// samples is that of Bartlett's formula (Box, Jenkins and Reinsel, Time Series Analysis, 4th ed., eq. (12.1.8)).
[[nodiscard]] ClockScan scan_clocks(const ImuSeries& imu, const GnssSeries& gnss, double gravity);

/// A shift that differing clocks make: whole hours (time zones, days, weeks, the epochs of 1970 and 1980), with or without leap seconds.
struct KnownShift {
    double shift = 0.0;  ///< s
    std::string name;    ///< "18 leap seconds", "GPS time counted from 1970", ...
};
/// The known shift that a measured one is, where the GNSS is late by earliest_lag to latest_lag beside it. @param leap seconds between UTC and GPS time
[[nodiscard]] std::optional<KnownShift> known_shift(double shift, double leap);

/// Drift of the IMU's clock against GNSS time.
struct ClockDrift {
    double ppm = 0.0;  ///< the IMU's seconds are shorter by this (its clock runs fast)
    double sigma = 0.0;
    bool found = false;
};
/// From the lags of the windows of a fit: the straight line along which the curves agree best; sigma by leaving out a twentieth at a time.
[[nodiscard]] ClockDrift drift_of(const std::vector<LagCurve>& curves);

/// Times of the IMU as the GNSS's clock tells them: t + shift, less the drift since `from`.
void set_clock(ImuSeries& imu, double shift, double drift_ppm, double from);

}  // namespace schuler::inspect::detail
