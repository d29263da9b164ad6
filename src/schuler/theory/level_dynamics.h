// Error dynamics of a strapdown INS in the local level after paper A, corrected, and its pendulum. Derived independently of the
// filters' models, to serve as a reference in their tests.
#pragma once

#include "schuler/core/position.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

namespace schuler::theory {

/// Errors (estimate minus truth) in paper A's order with angles instead of metres: longitude, latitude (rad), height (m),
/// velocity east, north, up (m/s), attitude about east, north, up (rad): C_est = (I - [alpha x]) C.
enum LevelError { d_lon = 0, d_lat = 1, d_h = 2, d_ve = 3, d_vn = 4, d_vu = 5, a_e = 6, a_n = 7, a_u = 8 };
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

/// F of (3.4.8) at a state, complete and corrected: math.md 2.3 with R_3 = 1 m, per second. v_enu, f_enu: velocity (m/s) and
/// specific force (m/s^2) east, north, up. Gravity: the vertical component of the model and its derivatives. Poles excluded.
/// Sensor errors (measured minus true, in east-north-up) enter the attitude rows with -1 (gyros), the velocity rows with +1.
[[nodiscard]] Matrix9 level_error_dynamics(const earth::Earth& earth, const Geodetic& position, const Eigen::Vector3d& v_enu,
                                           const Eigen::Vector3d& f_enu);

/// Specific force (east, north, up) that keeps the velocity constant, m/s^2.
[[nodiscard]] Eigen::Vector3d steady_level_force(const earth::Earth& earth, const Geodetic& position,
                                                 const Eigen::Vector3d& v_enu);

/// One horizontal channel at rest on a sphere: paper A, (1.4.4) to (1.4.7). Metres.
struct Pendulum {
    double g = 9.80665;    ///< m/s^2
    double R = 6371000.0;  ///< m

    [[nodiscard]] double frequency() const;                                ///< sqrt(g/R), rad/s
    [[nodiscard]] double from_tilt(double tilt, double t) const;           ///< R tilt (1 - cos w t)
    [[nodiscard]] double from_gyro(double drift, double t) const;          ///< R drift (t - sin(w t)/w), drift in rad/s
    [[nodiscard]] double from_velocity(double dv, double t) const;         ///< dv sin(w t)/w
    [[nodiscard]] double from_accelerometer(double bias, double t) const;  ///< bias (1 - cos w t)/w^2
};

}  // namespace schuler::theory
