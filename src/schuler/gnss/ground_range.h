// What the troposphere adds to a range between a ground station and an aircraft.
#pragma once

#include "schuler/core/position.h"

namespace schuler::gnss {

/// Excess path (m) along the bent ray between two points up to 470 km apart, from a refractivity of `n0` N-units at sea level that falls
/// exponentially with height (7350 m): four-point Gauss-Legendre integral along the chord less the bending term (math.md 5.7). Against a
/// ray traced through the same layers 5 mm between 20 and 200 km at 1 to 10 km of height.
[[nodiscard]] double ground_range_delay(const Geodetic& station, const Geodetic& aircraft, double chord, double n0 = 315.0);

}  // namespace schuler::gnss
