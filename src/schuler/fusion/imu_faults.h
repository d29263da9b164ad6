// What an inertial unit's own record says of its faults: axes that hang, shocks and bursts unlike the rest of the log, saturation.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/filter/update/timeline.h"

#include <cstddef>
#include <vector>

namespace schuler::fusion {

/// Samples of a unit that hangs: a rate or a force repeats to the last digit where in this log it hardly ever does; all three of a
/// sensor for a tenth of a second or more, a single axis for 0.3 s or more. `count`: how many there are.
[[nodiscard]] std::vector<bool> stuck_samples(const std::vector<ImuSample>& samples, double median_dt, std::size_t& count);

/// Stretches that are not to be trusted, with their noise, and the share of all samples that are at the end of an axis's range.
struct Doubts {
    std::vector<filter::Bridge> stretches;
    double saturated = 0.0;
};

/// Stretches of measured increments that are not to be trusted: their values stay, with the noise by which they may be wrong. Blocks of
/// half a second count as disturbed where neighbouring increments differ by far more than anywhere in the bulk of the log (a shock, an
/// electric spike, a burst): what departs from the block's median is then taken for an error, departures of one sign as one. Where an
/// axis stays at its largest value of the log it is saturated, and may be wrong by as much again for all of that time. Holes are left out.
[[nodiscard]] Doubts doubtful_stretches(const filter::ImuTimeline& timeline);

}  // namespace schuler::fusion
