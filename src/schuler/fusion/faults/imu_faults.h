// Detection of inertial sensor faults from their own data: frozen axes, shocks and bursts unlike the rest of the log, saturation.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/filter/update/timeline.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace schuler::fusion {

/// Samples of a frozen unit: a rate or a force repeats to the last digit, which in this log it hardly ever does; all three of a
/// sensor for a tenth of a second or more, a single axis for 0.3 s or more. `count`: their number.
[[nodiscard]] std::vector<bool> stuck_samples(const std::vector<ImuSample>& samples, double median_dt, std::size_t& count);

/// Unreliable intervals, with their noise, and the fraction of all samples at the end of an axis's range.
struct Doubts {
    std::vector<filter::Bridge> stretches;
    double saturated = 0.0;
};

/// Intervals of measured increments that are not reliable: their values are kept, with additional noise for their possible error.
/// Half-second blocks count as disturbed if neighbouring increments differ far more than in the bulk of the log (a shock, an
/// electric spike, a burst): the departure from the block's median is taken as an error, departures of one sign as one. An axis
/// that stays at its largest value in the log is saturated, and its error may be as large again over that time. Gaps are excluded.
/// C_bs: sensor axes to those of the increments.
[[nodiscard]] Doubts doubtful_stretches(const filter::ImuTimeline& timeline,
                                        const Eigen::Matrix3d& C_bs = Eigen::Matrix3d::Identity());

}  // namespace schuler::fusion
