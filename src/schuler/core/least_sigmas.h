// Standard deviations below those of any instrument: what states them is no measure of the error.
#pragma once

namespace schuler::least_sigma {

inline constexpr double position = 1e-4;    ///< m, of a receiver
inline constexpr double velocity = 1e-4;    ///< m/s, of a receiver or an odometer
inline constexpr double heading = 1e-5;     ///< rad
inline constexpr double range = 1e-3;       ///< m, of a pseudorange
inline constexpr double range_rate = 1e-5;  ///< m/s, by carrier phases too

}  // namespace schuler::least_sigma
