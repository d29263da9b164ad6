// Environmental aids: barometric height and magnetic heading.
#pragma once

#include "schuler/filter/measurement/measurement.h"
#include "schuler/filter/settings.h"

namespace schuler::filter {

/// Height compared with a barometric height; the barometer bias is a state. variance in m^2.
[[nodiscard]] Measurement baro_height(const Estimate& estimate, double measured, double variance);

/// Azimuth of the levelled magnetic field compared with the declination (rad, east positive); the constant offset is a state.
/// field_b in any unit. variance in rad^2. dof is 0 if the horizontal field is too small to define a direction.
[[nodiscard]] Measurement magnetic_azimuth(const Estimate& estimate, const Eigen::Vector3d& field_b, double declination,
                                           double variance);

/// The measurement of a sample with the sigma, and the declination and axes of the magnetometer, of the settings.
[[nodiscard]] Measurement measurement_of(const Estimate& estimate, const BaroSample& sample, const Settings& settings);
[[nodiscard]] Measurement measurement_of(const Estimate& estimate, const MagSample& sample, const Settings& settings);

}  // namespace schuler::filter
