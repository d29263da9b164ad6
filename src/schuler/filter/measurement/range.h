// Ranges and range rates between the antenna and a transmitter of known position, with their rows (paper D, math.md 5.3).
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

namespace schuler::filter {

/// The antenna of an estimate: shared by all rows of one epoch.
struct AntennaEstimate {
    Eigen::Vector3d r_e, v_e;  ///< m, m/s, Earth-fixed
    Geodetic place;            ///< position of the antenna
    Eigen::Matrix3d C_en;
    Eigen::Vector3d l_n;               ///< lever arm, m
    Eigen::Vector3d v_n;               ///< of the antenna, relative to the Earth, m/s
    Eigen::Vector3d turning;           ///< C_nb (w_ib_b x l_b), m/s: the part of v_n that rotates with the body's attitude
    Eigen::Vector3d for_heading;       ///< the part of it from which heading is derived (heading_force.h)
    Eigen::Vector3d w_ie_n;            ///< rad/s
    Eigen::Matrix3d by_displacement;   ///< rotation of the local level per displacement, 1/m
    Eigen::Matrix3d gyro_lever;        ///< C_nb [l_b x], m
    Eigen::Matrix3d C_nb, lever_turn;  ///< lever_turn: C_nb [w_ib_b x], rad/s, for the row of the lever arm
    double w_ie = 0.0;                 ///< rad/s
};

/// `w_ib_b` is the body's rate relative to inertial space, rad/s, less the estimated gyro errors; a rate up to `uncertain_rate` derives
/// neither the lever arm nor, as far as it is `heading_unknown` (0 to 1), the heading from the velocity of the antenna.
[[nodiscard]] AntennaEstimate antenna_of(const earth::Earth& earth, const NavState& nav, const Eigen::Matrix3d& C_nb,
                                         const Eigen::Vector3d& w_ib_b, const Eigen::Vector3d& lever_arm_b,
                                         double uncertain_rate = 0.0, double heading_unknown = 0.0);

/// Computed values without clocks and delays, and their rows with respect to errors north, east, down (estimate minus truth). The
/// change of the light time is neglected in the rows: 1e-6 of each entry.
struct RangeRows {
    double range = 0.0;     ///< m, including the Earth's rotation during the light time
    double rate = 0.0;      ///< m/s, exact
    double own_rate = 0.0;  ///< m/s, by the motion of the antenna alone: what a late reading of it changes
    Eigen::Vector3d u_n;    ///< unit vector from the transmitter to the antenna
    Eigen::Vector3d range_by_position, range_by_attitude, range_by_lever_arm;
    Eigen::Vector3d rate_by_position, rate_by_velocity, rate_by_attitude, rate_by_gyro_bias, rate_by_lever_arm;
};

/// The transmitter's position and velocity (relative to the Earth) in Earth-fixed axes of the time of transmission.
[[nodiscard]] RangeRows range_rows(const AntennaEstimate& antenna, const Ecef& transmitter, const Eigen::Vector3d& velocity);

}  // namespace schuler::filter
