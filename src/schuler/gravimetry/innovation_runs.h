// Whether the innovations of a survey's fixes have a mean anywhere, as a step of gravity gives them that the filter does not model.
#pragma once

#include "schuler/filter/result.h"

#include <cstddef>
#include <vector>

namespace schuler::gravimetry {

/// What is least probable about the innovations of a survey if the filter's model is right.
struct InnovationRun {
    filter::MeasurementKind kind = filter::MeasurementKind::GnssPosition;
    int axis = 0;              ///< north, east, down
    Time from, to;             ///< of the first and last fix of the stretch, or of all stretches
    double length = 0.0;       ///< s, of a stretch
    bool throughout = false;   ///< the means of all stretches of that length scatter too much; otherwise one of them is too large
    double sigmas = 0.0;       ///< of that mean, or root mean square of the means; one expected
    double probability = 1.0;  ///< of anything as improbable in a survey of the right model, at most
    std::size_t tests = 0;     ///< number compared; none: too few fixes

    [[nodiscard]] bool significant() const { return probability < 1e-3; }
};

/// Innovations of a filter with the right model are independent in time [BarShalom2001:5.4.2], whatever its noise and its states:
/// the sum of n of them, each over its sigma, has the variance n. Positions and velocities used from `settled` on, each axis by
/// itself, in stretches of 32, 64, ... fixes: each stretch (overlapping by half), as after a step; and all of them together, as of
/// a disturbance that varies.
[[nodiscard]] InnovationRun most_biased_run(const std::vector<filter::MeasurementRecord>& measurements, Time settled);

}  // namespace schuler::gravimetry
