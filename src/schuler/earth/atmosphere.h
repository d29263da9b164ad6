// International standard atmosphere: pressure, temperature and density from height, and height from pressure.
#pragma once

namespace schuler::earth {

/// Air of the standard atmosphere.
struct StandardAir {
    double temperature;  ///< K
    double pressure;     ///< Pa
    double density;      ///< kg/m^3
};

/// Heights of these functions are GEOPOTENTIAL metres above mean sea level (as indicated by an altimeter set to 1013.25 hPa),
/// -5000 to 80000 m, pressures 0.89 to 177687 Pa: ICAO Doc 7488/3, "Manual of the ICAO Standard Atmosphere", 3rd ed., 1993
/// (seven layers of constant temperature gradient, hydrostatic), g0 = 9.80665 m/s^2, R = 287.05287 m^2/(K s^2).
/// @throws Error(Input) outside this range or for NaN.
[[nodiscard]] StandardAir standard_air(double geopotential_height);
/// Height of a static pressure (Pa) with `sea_level_pressure` (Pa) and the standard temperature at sea level: QNH as applied by
/// altimeters (pressures in proportion). Inverse of standard_air().pressure to 1e-9 m below 20 km, 1e-7 m above. Same errors.
[[nodiscard]] double geopotential_height_from_pressure(double pressure, double sea_level_pressure = 101325.0);

/// Static pressure (Pa) in an atmosphere that is `temperature_offset` K warmer than the standard at every height, with
/// `sea_level_pressure` (Pa) at sea level: the same hydrostatic equation. @throws Error(Input) if an argument is out of range.
[[nodiscard]] double static_pressure(double geopotential_height, double sea_level_pressure, double temperature_offset);

/// Geometric from geopotential height and back, m: h = r H/(r - H), r = 6356766 m (Doc 7488/3).
[[nodiscard]] double geometric_from_geopotential(double geopotential_height);
[[nodiscard]] double geopotential_from_geometric(double geometric_height);

}  // namespace schuler::earth
