// Modelled delays of the atmosphere at one receiver.
#pragma once

#include "schuler/ppk/settings.h"
#include "schuler/ppk/tracking.h"

namespace schuler::ppk {

/// Tropospheric delay, and ionospheric delay on L1 (delays codes, advances phases; other carriers by 1/f^2), m.
struct AirDelay {
    double troposphere = 0, ionosphere = 0;
};
[[nodiscard]] AirDelay air_delay(const AirModel& model, const TrackedSatellite& satellite, const Geodetic& receiver,
                                 gnss::Direction direction);
/// Ionospheric delay of a carrier as a multiple of that on L1.
[[nodiscard]] double ionosphere_factor(double wavelength);

}  // namespace schuler::ppk
