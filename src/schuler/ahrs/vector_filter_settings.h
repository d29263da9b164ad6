// Settings of paper B's filters, which know the sensors' noise and, where they need it, the field.
#pragma once

#include "schuler/core/units.h"

namespace schuler::ahrs {

/// How the quaternion filter keeps the magnetometer out of the tilt.
enum class Separation {
    Projected,  ///< horizontal measurement, and the gain projected on the rotation about the vertical: exact
    Printed,    ///< as printed in the paper: horizontal measurement only; leaves up to 0.3 deg
    None,       ///< not separated: the whole field as a reference vector, for comparison
};

struct VectorFilterSettings {
    double gyro_noise = 0.1 * units::deg;  ///< rad/sqrt(s), with what bias and scale factor add
    double accel_std = 1.0;                ///< m/s^2 a sample, with the accelerations of the motion
    double field_std = 2e-6;               ///< T a sample, with the disturbances of the place
    double gravity = 9.81;                 ///< m/s^2
    double horizontal_field = 19e-6;       ///< T, known beforehand: dcm and the unseparated filter
    double vertical_field = 46e-6;         ///< T, down
    Separation separation = Separation::Projected;
    double regularization = 1e-6;  ///< alpha of the quaternion filter's measurement covariance

    /// @throws Error(Input) naming the setting.
    void check() const;
};

}  // namespace schuler::ahrs
