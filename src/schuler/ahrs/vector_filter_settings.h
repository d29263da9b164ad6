// Settings of paper B's filters, which require the sensor noise and, in some cases, the field.
#pragma once

#include "schuler/core/units.h"

namespace schuler::ahrs {

/// How the quaternion filter prevents the magnetometer from affecting the tilt.
enum class Separation {
    Projected,  ///< horizontal measurement, and the gain projected onto the rotation about the vertical: exact
    Printed,    ///< as printed in the paper: horizontal measurement only; leaves up to 0.3 deg
    None,       ///< not separated: the whole field as a reference vector, for comparison
};

struct VectorFilterSettings {
    double gyro_noise = 0.1 * units::deg;  ///< rad/sqrt(s), including the effects of bias and scale factor
    double accel_std = 1.0;                ///< m/s^2 per sample, including accelerations of the motion
    double field_std = 2e-6;               ///< T per sample, including local disturbances
    double gravity = 9.81;                 ///< m/s^2
    double horizontal_field = 19e-6;       ///< T, assumed known: dcm and the unseparated filter
    double vertical_field = 46e-6;         ///< T, down
    Separation separation = Separation::Projected;
    double regularization = 1e-6;  ///< alpha of the quaternion filter's measurement covariance

    /// @throws Error(Input) that names the setting.
    void check() const;
};

}  // namespace schuler::ahrs
