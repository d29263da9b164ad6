// Position, velocity and clock of a satellite at transmission.
#pragma once

#include "schuler/core/position.h"
#include "schuler/gnss/ephemeris.h"

#include <Eigen/Core>

namespace schuler::gnss {

/// Earth rotation rate used in the orbit elements of GPS, QZSS and Galileo, rad/s [ISGPS200:table 20-IV].
inline constexpr double gps_earth_rate = 7.2921151467e-5;

/// Satellite state at an instant of GPS time, in Earth-fixed axes of that instant.
struct SatelliteState {
    Ecef position;                      ///< m
    Eigen::Vector3d velocity{0, 0, 0};  ///< m/s, relative to the Earth
    double clock = 0;                   ///< s, satellite minus system time, relativistic eccentricity term included
    double clock_rate = 0;              ///< s/s
    double variance = 0;                ///< m^2, of orbit and clock along the line of sight
};

/// Orbit and clock from Keplerian elements [ISGPS200:tables 20-IV, 30-II, 20.3.3.3.3.1], [GalileoICD:table 66], [BeiDouICD:5.2.4.12] with the
/// rotated frame of BeiDou's geostationary satellites. The velocity is the exact derivative of the position.
[[nodiscard]] SatelliteState satellite_state(const KeplerEphemeris& ephemeris, Time t);

/// Orbit by Runge-Kutta integration (steps of at most 60 s) of the equations of [GLONASSICD:A.3.1.2]; 0.1 m of integration error
/// would take hours to accumulate. Positions are in the ephemeris's PZ-90.11, within 2 cm of WGS-84.
[[nodiscard]] SatelliteState satellite_state(const GlonassEphemeris& ephemeris, Time t);

/// Quadratic motion [RTCA229:A.4.4.11].
[[nodiscard]] SatelliteState satellite_state(const SbasEphemeris& ephemeris, Time t);

/// Code delay of a signal relative to the broadcast clock, s: the pseudorange error of the satellite's hardware. From T_GD, BGD
/// [ISGPS200:20.3.3.3.3.2], [GalileoICD:5.1.5], [BeiDouICD:5.2.4.10]; zero if not broadcast.
[[nodiscard]] double group_delay(const KeplerEphemeris& ephemeris, Signal signal);
[[nodiscard]] double group_delay(const GlonassEphemeris& ephemeris, Signal signal);

}  // namespace schuler::gnss
