// Tropospheric delay of a range between a ground station and an aircraft.
#pragma once

#include "schuler/core/position.h"

namespace schuler::gnss {

/// Excess path (m) along the bent ray between two points up to 470 km apart, for a refractivity of `n0` N-units at sea level that decays
/// exponentially with height (7350 m): four-point Gauss-Legendre integral along the chord minus the bending term (math.md 5.7). Agrees
/// with ray tracing through the same layers to 5 mm at 20 to 200 km distance and 1 to 10 km height.
[[nodiscard]] double ground_range_delay(const Geodetic& station, const Geodetic& aircraft, double chord, double n0 = 315.0);

}  // namespace schuler::gnss
