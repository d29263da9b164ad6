// IMU time relative to GNSS time from the motion recorded by both logs: no attitude, units or biases required.
#pragma once

#include "schuler/inspect/detail/motion/motion.h"
#include "schuler/inspect/detail/motion/motion_fit.h"

#include <optional>
#include <string>
#include <vector>

namespace schuler::inspect::detail {

/// s: range of apparent lags of a receiver's fixes behind the IMU with correct clocks, and its middle.
inline constexpr double earliest_lag = -0.2, latest_lag = 1.2, middle_lag = 0.4;

/// Agreement of the logs if the IMU's times are shifted later by `shift`.
struct ClockPeak {
    double shift = 0.0;        ///< s
    double support = 0.0;      ///< log of the likelihood ratio against no relation
    double correlation = 0.0;  ///< of the most significant channel
};

/// The agreement of two logs for every shift with an overlap of at least 10 s.
struct ClockScan {
    std::vector<ClockPeak> peaks;  ///< local maxima, the best first
    double stated = 0.0;           ///< support of the unshifted times, within the lags of a receiver; 0 without common time
    double width = 0.0;            ///< s: peaks closer than this are considered one
    double asked = 0.0;            ///< largest support within `width` of the shift asked for
};

/// What is correlated: the values, or their ranks, in which a few seconds count no more than others, however strong their signal is.
enum class ScanOf { Values, Ranks };

/// Correlates, over all shifts, the rate about the vertical with the rate of the course, the magnitude of the specific force with that
/// of the track's acceleration minus gravity, and the force across the mean vertical with the horizontal acceleration. The number of
/// independent samples is that of Bartlett's formula (Box, Jenkins and Reinsel, Time Series Analysis, 4th ed., eq. (12.1.8)).
[[nodiscard]] ClockScan scan_clocks(const ImuSeries& imu, const GnssSeries& gnss, double gravity, ScanOf what = ScanOf::Values,
                                    double asked = 0.0);

/// A shift caused by different clocks: whole hours (time zones, days, weeks, the epochs of 1970 and 1980), with or without leap seconds.
struct KnownShift {
    double shift = 0.0;  ///< s
    std::string name;    ///< "18 leap seconds", "GPS time counted from 1970", ...
};
/// The known shift that agrees with a measured one, with a GNSS lag of earliest_lag to latest_lag. @param leap seconds between UTC and GPS time
[[nodiscard]] std::optional<KnownShift> known_shift(double shift, double leap);

/// Drift of the IMU's clock against GNSS time.
struct ClockDrift {
    double ppm = 0.0;  ///< the IMU's seconds are shorter by this (its clock runs fast)
    double sigma = 0.0;
    bool found = false;
};
/// From the lags of the windows of a fit: the straight line of best agreement of the curves; sigma by leaving out a twentieth at a time.
[[nodiscard]] ClockDrift drift_of(const std::vector<LagCurve>& curves);

/// Converts times of the IMU to the GNSS clock: t + shift, minus the drift since `from`.
void set_clock(ImuSeries& imu, double shift, double drift_ppm, double from);

}  // namespace schuler::inspect::detail
