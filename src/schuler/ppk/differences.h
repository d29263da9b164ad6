// Single differences: rover measurements minus those of the base, each minus its model.
#pragma once

#include "schuler/ppk/base_station.h"
#include "schuler/ppk/settings.h"

#include <vector>

namespace schuler::ppk {

/// One signal of one satellite at an assumed position of the rover, m. code = clocks + towards . dx + mapping dT + factor dI +
/// noise and phase = clocks + towards . dx + mapping dT - factor dI + ambiguity + noise, with dx true minus assumed position, dT
/// and dI the zenith delay and the satellite's ionospheric delay on L1, rover minus base, beyond the models.
struct Difference {
    SatelliteId id;
    std::uint8_t slot = 0;  ///< in the plan
    char band = '1';
    bool whole = true;    ///< the ambiguity is an integer number of cycles (relative to another of the same system and carrier)
    bool halves = false;  ///< an integer number of half cycles instead
    Eigen::Vector3d towards{0, 0, 0};
    double elevation = 0;
    double mapping = 1;
    double factor = 1;  ///< of the ionosphere
    double wavelength = 0;
    double code = not_given, phase = not_given;
    double code_variance = 0, phase_variance = 0;  ///< m^2
    double left = 0;                               ///< m^2, part of both that air, orbit and satellite clock leave
    double repeated = 0;                           ///< m^2, part of the phase variance common to neighbouring epochs
    int rover_arc = 0, base_arc = 0;

    /// Of the vertical ionospheric delay on L1, common to all satellites.
    [[nodiscard]] double vertical_factor() const;
};

/// System and carrier, within which ambiguities are integers relative to each other.
[[nodiscard]] inline int group_of(const Difference& d) { return static_cast<int>(d.id.system) * 256 + static_cast<int>(d.band); }

/// Signals with a phase at both receivers, at the assumed position of the rover.
[[nodiscard]] std::vector<Difference> single_differences(const TrackedEpoch& rover, const BaseEpoch& base,
                                                         const BaseStation& station, const SignalPlan& plan, const Ecef& position,
                                                         const Settings& settings, bool ionosphere_is_estimated);

/// Increase of a vertical delay towards the horizon, 1 at the zenith: for the troposphere, and for a shell at 350 km.
[[nodiscard]] double air_mapping(double elevation);
[[nodiscard]] double shell_mapping(double elevation);

}  // namespace schuler::ppk
