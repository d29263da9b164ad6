// Heights by depth gauges, barometers and altimeters at places of their own on the body.
#pragma once

#include "schuler/filter/measurement/measurement.h"

#include <array>

namespace schuler::filter {

/// Heights above the ellipsoid (m, those that are finite) of up to three gauges at their lever arms (IMU to gauge, m, body), each less
/// an unknown level where the layout has it. Two gauges on a line along the body tell pitch, a third one beside it tells roll.
/// variance in m^2. The turn of the vertical over a lever arm is left out: 1e-5 of a millimetre at ten metres.
[[nodiscard]] Measurement gauge_heights(const Estimate& estimate, const Eigen::Vector3d& heights, double variance,
                                        const std::array<Eigen::Vector3d, 3>& lever_arms_b);

}  // namespace schuler::filter
