// Phase centres of antennas: of receivers against their reference point, of satellites against their centre of mass.
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/time.h"
#include "schuler/gnss/atmosphere.h"
#include "schuler/gnss/satellite.h"

#include <Eigen/Core>

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::gnss {

/// Variation of a phase on a grid: zenith angles (receivers) or nadir angles (satellites) from `first` in steps of `step`, rad; a
/// row for each azimuth from 0 to 2 pi, or a single one for all.
struct PhasePattern {
    double first = 0, step = 0;
    std::vector<std::vector<double>> rows;  ///< m
    /// Linear between the nodes, constant beyond them; 0 without any.
    [[nodiscard]] double at(double zenith, double azimuth) const;
};

/// An antenna on one carrier [ANTEX14].
struct AntennaCarrier {
    double frequency = 0;             ///< Hz
    Eigen::Vector3d offset{0, 0, 0};  ///< m: north, east and up of the reference point; of satellites along their axes
    PhasePattern variation;
};

/// A calibrated antenna. Carriers that were not calibrated are taken to be like the nearest one that was.
struct Antenna {
    std::string type;  ///< of a receiver: twenty characters of name and radome
    std::vector<AntennaCarrier> carriers;

    [[nodiscard]] const AntennaCarrier* on(double frequency) const;  ///< null without carriers
    /// m, to be added to a measured code or phase of a level antenna oriented to the north, so that it refers to the reference point:
    /// the offset along the direction minus the variation.
    [[nodiscard]] double to_reference_point(double frequency, Direction direction) const;
};

/// An antenna of a satellite from `from` until `until`, GPS time.
struct SatelliteAntenna {
    SatelliteId satellite;
    Time from{std::numeric_limits<std::int64_t>::min()}, until{std::numeric_limits<std::int64_t>::max()};
    Antenna antenna;
};

/// The antennas of a calibration file.
struct Antennas {
    std::vector<Antenna> receivers;
    std::vector<SatelliteAntenna> satellites;

    /// The receiver antenna of this name, as headers of observations write it; without its radome if that one is not known. Null
    /// if there is none.
    [[nodiscard]] const Antenna* of_receiver(std::string_view type) const;
    [[nodiscard]] const Antenna* of_satellite(SatelliteId satellite, Time t) const;
};

/// Unit vector to the sun, Earth-fixed: the Astronomical Almanac's low-precision formulae, 0.01 deg from 1950 to 2050.
[[nodiscard]] Eigen::Vector3d direction_of_sun(Time t);

/// Phase centre of a satellite relative to its centre of mass, Earth-fixed, m: the z axis towards the Earth, y along the solar
/// panels, that is, z cross the direction of the sun [ANTEX14:3].
[[nodiscard]] Eigen::Vector3d satellite_phase_centre(const Antenna& antenna, double frequency, const Ecef& satellite, Time t);

}  // namespace schuler::gnss
