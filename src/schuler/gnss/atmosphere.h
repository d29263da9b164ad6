// What the ionosphere and the troposphere add to a pseudorange.
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
/// frequencies: times (f_L1/f)^2. GPS time.
[[nodiscard]] double klobuchar_delay(const KlobucharCoefficients& coefficients, Time t, const Geodetic& receiver,
                                     Direction direction);

/// The same of BeiDou on B1I (1561.098 MHz) [BeiDouICD:5.2.4.7]: eight coefficients of the same form that refer to geographic instead of
/// geomagnetic latitude, and a shell at 375 km, m. Other frequencies: times (f_B1I/f)^2. GPS time.
[[nodiscard]] double beidou_klobuchar_delay(const KlobucharCoefficients& coefficients, Time t, const Geodetic& receiver,
                                            Direction direction);

/// What is known of the ionosphere from the satellites' messages.
struct BroadcastIonosphere {
    std::optional<KlobucharCoefficients> klobuchar;  ///< of GPS, or of QZSS or NavIC, which have the same form
    std::optional<KlobucharCoefficients> beidou;
};
/// From everything that was received. Without any coefficients a mean ionosphere stands for them.
[[nodiscard]] BroadcastIonosphere broadcast_ionosphere(const Navigation& navigation);

/// A delay and the sigma of what a model leaves of it, m.
struct IonosphericDelay {
    double delay = 0, sigma = 0;
};
/// On a carrier of `frequency` Hz, by the model of the system itself where there is one, else by another's. A broadcast model removes half
/// of the delay [Klobuchar1987]; where two disagree about a system that has none of its own, so much is added to its sigma. Without
/// coefficients: a mean day, whose sigma is the whole of it.
[[nodiscard]] IonosphericDelay ionospheric_delay(const BroadcastIonosphere& ionosphere, System system, double frequency, Time t,
                                                 const Geodetic& receiver, Direction direction);

/// Zenith delays, m.
struct ZenithDelay {
    double hydrostatic = 0;
    double wet = 0;
};
/// [Saastamoinen1972] in the standard atmosphere at the receiver's height (taken as the height above sea level, -1 to 20 km) with a
/// relative humidity from 0 to 1.
[[nodiscard]] ZenithDelay saastamoinen_zenith(const Geodetic& receiver, double relative_humidity);

/// How a zenith delay grows towards the horizon.
enum class Mapping {
    Niell,     ///< [Niell1996] with latitude, season and height; used down to 3 degrees
    Cosecant,  ///< 1/sin(elevation): too large by 0.2 m at 10 degrees
};
[[nodiscard]] double troposphere_delay(const ZenithDelay& zenith, Mapping mapping, Time t, const Geodetic& receiver,
                                       double elevation);

}  // namespace schuler::gnss
