// Heights from depth gauges, barometers and altimeters at separate positions on the body.
#pragma once

#include "schuler/filter/measurement/measurement.h"
#include "schuler/filter/settings.h"

#include <array>

namespace schuler::filter {

/// Heights above the ellipsoid (m; finite values only) of up to three gauges at their lever arms (IMU to gauge, m, body), each
/// less an unknown level if the layout includes it. Two gauges along the body axis determine pitch, a third one beside it roll.
/// variance in m^2. The rotation of the vertical over a lever arm is neglected: 1e-5 mm at ten metres.
[[nodiscard]] Measurement gauge_heights(const Estimate& estimate, const Eigen::Vector3d& heights, double variance,
                                        const std::array<Eigen::Vector3d, 3>& lever_arms_b);

/// The measurement of a sample with the sigma and lever arms of the settings.
[[nodiscard]] Measurement measurement_of(const Estimate& estimate, const GaugeSample& sample, const Settings& settings);

}  // namespace schuler::filter
