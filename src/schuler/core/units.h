// Factors from external units to SI: value_si = value * factor. Used at interfaces only; internally all is SI and radians.
#pragma once

#include <numbers>

namespace schuler::units {

inline constexpr double deg = std::numbers::pi / 180.0;  ///< rad
inline constexpr double arcmin = deg / 60.0;             ///< rad
inline constexpr double arcsec = deg / 3600.0;           ///< rad
inline constexpr double hour = 3600.0;                   ///< s
inline constexpr double deg_per_s = deg;                 ///< rad/s
inline constexpr double deg_per_hour = deg / hour;       ///< rad/s
inline constexpr double deg_per_sqrt_hour = deg / 60.0;  ///< rad/sqrt(s)
inline constexpr double m_s_per_sqrt_hour = 1.0 / 60.0;  ///< m/s/sqrt(s)
inline constexpr double g0 = 9.80665;                    ///< m/s^2, standard gravity as a unit, not a model
inline constexpr double mg = 1e-3 * g0;                  ///< m/s^2 (milli-g)
inline constexpr double ug = 1e-6 * g0;                  ///< m/s^2 (micro-g)
inline constexpr double mgal = 1e-5;                     ///< m/s^2
inline constexpr double ppm = 1e-6;
inline constexpr double gauss = 1e-4;       ///< T
inline constexpr double microtesla = 1e-6;  ///< T

}  // namespace schuler::units
