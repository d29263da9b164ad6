// Environmental measurements: barometric height and magnetic heading.
#pragma once

#include "schuler/filter/measurement/measurement.h"
#include "schuler/filter/settings.h"

namespace schuler::filter {

/// Height compared with a barometric height; the barometer bias is a state. variance in m^2.
[[nodiscard]] Measurement baro_height(const Estimate& estimate, double measured, double variance);

/// Azimuth of the levelled magnetic field compared with that of the Earth's field at the declination (rad, east positive) and of
/// the body's hard iron; a constant offset and the hard iron are states. field_b in any unit. variance in rad^2. dof is 0 if the
/// horizontal field is too small to define a direction.
///
/// Hard iron d, constant in body axes, in units of the Earth's horizontal field, deviates the levelled field of a body without tilt
/// by d_x sin(psi) + d_y cos(psi) to first order, psi: magnetic heading. These are coefficients B and C of compass deviation; d_z acts
/// through tilt (hard iron and its calibration: [Groves2013:6.1.1]). Large deviations are not linearised.
[[nodiscard]] Measurement magnetic_azimuth(const Estimate& estimate, const Eigen::Vector3d& field_b, double declination,
                                           double variance);

/// The same as a measurement of the heading alone: the tilt's error counts as noise and is not corrected. Errors of the field that are
/// not modelled (soft iron, motors, large deviations) would otherwise be taken for a tilt, by the dip several times as visible here
/// as it is by the accelerometers.
[[nodiscard]] Measurement without_tilt(const Estimate& estimate, Measurement magnetic_azimuth);

/// Derivative of the levelled field's azimuth with respect to hard iron in body axes, at the value iron_n (local level).
[[nodiscard]] Eigen::RowVector3d deviation_by_iron(const Eigen::Matrix3d& C_nb, double azimuth, const Eigen::Vector3d& iron_n);

/// The measurement of a sample with the sigma, and the declination and axes of the magnetometer, of the settings. Of the heading alone
/// unless the sigmas of deviation and disturbance are those of a calibrated magnetometer, at most 2 degrees.
[[nodiscard]] Measurement measurement_of(const Estimate& estimate, const BaroSample& sample, const Settings& settings);
[[nodiscard]] Measurement measurement_of(const Estimate& estimate, const MagSample& sample, const Settings& settings);

}  // namespace schuler::filter
