// Pseudorange delays due to the ionosphere and the troposphere.
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/time.h"
#include "schuler/gnss/ephemeris.h"

#include <optional>

namespace schuler::gnss {

/// Direction of a satellite from a receiver, rad: azimuth clockwise from north in (-pi, pi], elevation above the ellipsoid's horizon.
struct Direction {
    double azimuth = 0;
    double elevation = 0;
};
[[nodiscard]] Direction direction_to(const Ecef& satellite, const Ecef& receiver, const Geodetic& receiver_geodetic);

/// Group delay of the ionosphere on L1 (1575.42 MHz) by the broadcast model [Klobuchar1987], [ISGPS200:20.3.3.5.2.5], m. Other
/// frequencies: multiply by (f_L1/f)^2. GPS time.
[[nodiscard]] double klobuchar_delay(const KlobucharCoefficients& coefficients, Time t, const Geodetic& receiver,
                                     Direction direction);

/// The corresponding model of BeiDou on B1I (1561.098 MHz) [BeiDouICD:5.2.4.7]: eight coefficients of the same form, referred to
/// geographic instead of geomagnetic latitude, and a shell at 375 km, m. Other frequencies: multiply by (f_B1I/f)^2. GPS time.
[[nodiscard]] double beidou_klobuchar_delay(const KlobucharCoefficients& coefficients, Time t, const Geodetic& receiver,
                                            Direction direction);

/// Ionosphere data from the satellites' navigation messages.
struct BroadcastIonosphere {
    std::optional<KlobucharCoefficients> klobuchar;  ///< of GPS, or of QZSS or NavIC, which use the same form
    std::optional<KlobucharCoefficients> beidou;
};
/// Extracted from all received messages. Without any coefficients a mean ionosphere is used.
[[nodiscard]] BroadcastIonosphere broadcast_ionosphere(const Navigation& navigation);

/// A delay and the sigma of the residual error of its model, m.
struct IonosphericDelay {
    double delay = 0, sigma = 0;
};
/// On a carrier of `frequency` Hz, by the model of the system itself if available, else by that of another. A broadcast model removes
/// half of the delay [Klobuchar1987]; if two models differ for a system without its own, their difference is added to the sigma.
/// Without coefficients: a mean ionosphere whose sigma is at least its delay.
[[nodiscard]] IonosphericDelay ionospheric_delay(const BroadcastIonosphere& ionosphere, System system, double frequency, Time t,
                                                 const Geodetic& receiver, Direction direction);

/// Zenith delays, m.
struct ZenithDelay {
    double hydrostatic = 0;
    double wet = 0;
};
/// [Saastamoinen1972] in the standard atmosphere at the receiver's height (used as height above sea level, -1 to 20 km) with a
/// relative humidity from 0 to 1.
[[nodiscard]] ZenithDelay saastamoinen_zenith(const Geodetic& receiver, double relative_humidity);

/// Increase of the zenith delay towards the horizon.
enum class Mapping {
    Niell,     ///< [Niell1996], depends on latitude, season and height; valid down to 3 degrees
    Cosecant,  ///< 1/sin(elevation): too large by 0.2 m at 10 degrees
};
[[nodiscard]] double troposphere_delay(const ZenithDelay& zenith, Mapping mapping, Time t, const Geodetic& receiver,
                                       double elevation);

}  // namespace schuler::gnss
