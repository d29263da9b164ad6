// Linear error dynamics of the mechanizations, error = estimate minus truth, C_est = (I - [phi x]) C (docs/conventions.md).
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

namespace schuler::ins {

/// Blocks of the 9 x 9 dynamics of (position, velocity, attitude) errors, per second. Gyro-bias errors enter the attitude
/// rows with +C and accelerometer-bias errors the velocity rows with -C, C = C_nb or C_eb.
struct ErrorDynamics {
    Eigen::Matrix3d pp, pv;      ///< position rows: with respect to position (1/s), velocity
    Eigen::Matrix3d vp, vv, va;  ///< velocity rows: with respect to position (1/s^2), velocity (1/s), attitude (m/s^2)
    Eigen::Matrix3d ap, av, aa;  ///< attitude rows: with respect to position (1/(m s)), velocity (1/m), attitude (1/s)
};

/// The blocks as one matrix, in the order position, velocity, attitude.
[[nodiscard]] Eigen::Matrix<double, 9, 9> matrix(const ErrorDynamics& dynamics);

/// Geographic frame: dr in metres north, east, down as in math.md 5.1 (dr_N = (R_M + h) dlat, ...), dv of v_eb_n, phi in n.
/// math.md 5.2, exact derivatives; for the north component of gravity only the change with height is kept (that with latitude is
/// below 3e-11 1/s^2 at 10 km). f_n: specific force in n, m/s^2. Poles excluded.
[[nodiscard]] ErrorDynamics error_n(const earth::Earth& earth, const Geodetic& position, const Eigen::Vector3d& v_eb_n,
                                    const Eigen::Vector3d& f_n);
/// The same if terms_at(earth, position, v_eb_n) is already known.
[[nodiscard]] ErrorDynamics error_n(const earth::Earth& earth, const earth::EarthTerms& terms, const Geodetic& position,
                                    const Eigen::Vector3d& v_eb_n, const Eigen::Vector3d& f_n);

/// Earth-fixed frame: dr of r_eb_e, dv of v_eb_e, phi in e. f_e: specific force in e, m/s^2. math.md section 4 with the sign
/// estimate minus truth, and with the gradient of the gravity model in use (including its ellipsoidal and centrifugal parts)
/// instead of that of a point mass. No positions are excluded.
[[nodiscard]] ErrorDynamics error_e(const earth::Earth& earth, const Ecef& position, const Eigen::Vector3d& f_e);

/// Rotation (rad) of the local level relative to the Earth for a displacement in metres north, east, down: w_en_n = L v_eb_n.
[[nodiscard]] Eigen::Matrix3d level_rotation_by_displacement(const earth::EarthTerms& terms);

/// Maps Earth-fixed errors (dr_e, dv_e, phi_e) to geographic ones (dr_n, dv_n, phi_n): 9 x 9, first order, exact. A position
/// error rotates the computed local level by d = L dr_n: dv_n = C_ne dv_e - d x v_n, phi_n = C_ne phi_e + d.
[[nodiscard]] Eigen::Matrix<double, 9, 9> geographic_from_ecef_errors(const earth::Earth& earth, const NavState& state);

}  // namespace schuler::ins
