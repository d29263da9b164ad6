// Wheel speed, and heading from a dedicated sensor.
#pragma once

#include "schuler/filter/measurement/measurement.h"
#include "schuler/filter/settings.h"

namespace schuler::filter {

/// Forward speed (m/s, negative backwards) of the vehicle's unsteered axle, as measured by the odometer: (1 + scale) times the
/// velocity along the vehicle's forward axis. Mounting, axle and scale are included if they are states. variance in m^2/s^2.
[[nodiscard]] Measurement odometer_speed(const Estimate& estimate, double measured, double variance);

/// Heading (rad, from true north, of the body's forward axis) from two antennas or a gyrocompass; its constant offset is a state
/// if the layout includes it. variance in rad^2. dof is 0 if the forward axis is within a degree of the vertical.
[[nodiscard]] Measurement heading_of_body(const Estimate& estimate, double measured, double variance);

/// The measurement of a sample, with its own sigma or else that of the settings.
[[nodiscard]] Measurement measurement_of(const Estimate& estimate, const OdometerSample& sample, const Settings& settings);
[[nodiscard]] Measurement measurement_of(const Estimate& estimate, const HeadingSample& sample, const Settings& settings);

}  // namespace schuler::filter
