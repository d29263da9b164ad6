// Nominal constellations as broadcast ephemerides, and selection among the satellites in view.
#pragma once

#include "schuler/core/position.h"
#include "schuler/gnss/satellite_source.h"

#include <cstddef>
#include <span>
#include <vector>

namespace schuler::gnss {

/// The 24 slots of GPS on circular orbits of 26 559.71 km at 55 degrees [ISGPS200], as ephemerides every two hours over [from, to].
/// The slot longitudes are referred to Greenwich at 277.85 degrees of right ascension at the start of the GPS week of `from`.
[[nodiscard]] Navigation nominal_gps(Time from, Time to);

/// The 24 slots of GLONASS: three planes at 64.8 degrees, eight satellites each, 25 508 km [GLONASSICD]. Each satellite is integrated
/// once over the whole time, so that its ephemerides (every 30 minutes) agree with each other to a millimetre.
[[nodiscard]] Navigation nominal_glonass(Time from, Time to);

/// A satellite as seen from a place.
struct Sighting {
    SatelliteId satellite;
    double elevation = 0;                    ///< rad
    Eigen::Vector3d line_of_sight{0, 0, 0};  ///< unit vector from the satellite to the receiver, Earth-fixed
};
/// Healthy satellites above a mask (rad) at an instant, highest first. Light time is neglected.
[[nodiscard]] std::vector<Sighting> satellites_in_view(const SatelliteSource& source, std::span<const SatelliteId> among, Time t,
                                                       const Ecef& receiver, double mask);

/// Position dilution of precision of these satellites with one clock; infinite for fewer than four or a singular geometry.
[[nodiscard]] double pdop(std::span<const Sighting> sightings);

/// Indices of the four satellites with the least PDOP, in order; all of them if there are four or fewer.
[[nodiscard]] std::vector<std::size_t> best_four(std::span<const Sighting> sightings);

/// All satellites with ephemerides, in order.
[[nodiscard]] std::vector<SatelliteId> satellites_of(const Navigation& navigation);

}  // namespace schuler::gnss
