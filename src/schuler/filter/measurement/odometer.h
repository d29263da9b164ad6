// Speed of a wheel, and heading by a sensor of its own.
#pragma once

#include "schuler/filter/measurement/measurement.h"

namespace schuler::filter {

/// Forward speed (m/s, backwards negative) of the vehicle's unsteered axle, as the odometer shows it: (1 + scale) times the velocity
/// along the vehicle's forward axis. Mounting, axle and scale take part where they are states. variance in m^2/s^2.
[[nodiscard]] Measurement odometer_speed(const Estimate& estimate, double measured, double variance);

/// Heading (rad, from true north, of the body's forward axis) by two antennas or a gyrocompass; its constant offset is a state where
/// the layout has it. variance in rad^2. dof is 0 where the forward axis is within a degree of the vertical.
[[nodiscard]] Measurement heading_of_body(const Estimate& estimate, double measured, double variance);

}  // namespace schuler::filter
