// Pseudoranges and range rates along a truth path: satellites and ground stations, their errors, masks and faults.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"
#include "schuler/gnss/ranges.h"
#include "schuler/sensor/range_errors.h"
#include "schuler/sim/path.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace schuler::sim {

/// A ground station of surveyed position that transmits at known times.
struct GroundStation {
    std::string name;
    Geodetic position;
};

/// Sources are silent for start <= t < start + duration, seconds of the scenario. No names: all satellites; "stations": all stations.
struct Blocking {
    std::vector<std::string> sources;
    double start = 0.0, duration = 1e9;
};

/// From `start` on only some of the satellites in view. Up to four are taken from the four of least PDOP at the middle of the
/// scenario, the highest first: with three, number `variant` mod 4 is omitted; two are pair `variant` mod 6; one is number
/// `variant` mod 4. More than four: the highest.
struct SatelliteLimit {
    double start = 0.0;
    std::size_t keep = 4;
    std::size_t variant = 0;
};

/// A wrong pseudorange: error offset + ramp (t - start); the error of its rate is given by `ramp` and `rate`.
struct RangeFault {
    std::string source;
    double start = 0.0, duration = 1e9;  ///< s
    double offset = 0.0;                 ///< m
    double ramp = 0.0, rate = 0.0;       ///< m/s

    [[nodiscard]] bool active(double t) const { return t >= start && t < start + duration; }
    /// While it is active: of the range, m, and of its rate, m/s.
    [[nodiscard]] double error(double t) const { return offset + ramp * (t - start); }
    [[nodiscard]] double rate_error() const { return ramp + rate; }
    /// Of a signal whose range changes by its rate, m.
    [[nodiscard]] double of_carrier(double t) const { return offset + rate_error() * (t - start); }
};

/// Multipath: amplitude cos(elevation) sin(2 pi t/period + phase), with a separate phase for each source.
struct Multipath {
    double amplitude = 0.0;  ///< m
    double period = 60.0;    ///< s
};

/// Satellite masks: an elevation mask, one that varies with azimuth, one relative to the antenna plane.
struct Masks {
    double elevation = 0.13089969389957470;  ///< rad (7.5 degrees)
    bool throughout = false;                 ///< only satellites above `elevation` during the whole scenario
    struct Sector {
        double azimuth, elevation;  ///< rad: from this azimuth to the next sector's
    };
    std::vector<Sector> terrain;    ///< in order of azimuth, 0 to 2 pi; empty: flat
    std::optional<double> antenna;  ///< rad above the antenna's plane (body axes), for a banking vehicle
};

struct RangingSettings {
    double rate = 1.0;                                      ///< Hz
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< IMU to antenna, m
    gnss::Navigation navigation;                            ///< satellites; none: stations alone
    std::vector<GroundStation> stations;
    sensor::RangingErrorModel errors;
    Masks masks;
    std::vector<Blocking> blocked;
    std::vector<SatelliteLimit> limits;
    std::vector<RangeFault> faults;
    Multipath multipath;
    bool atmosphere = false;  ///< troposphere, and the ionosphere of the navigation data's coefficients
};

/// The frame of the simulation, shared by simulate() and the ranges.
struct RangingScenario {
    std::uint64_t seed = 1;
    double duration = 600.0;  ///< s
    Time origin;              ///< time of the first instant in the logs
    Time gps;                 ///< GPS time of the first instant
    earth::Earth earth;
};

/// Clock and offset at each epoch, for evaluation of the filter.
struct RangingTruth {
    Time time;
    double clock, drift;  ///< m, m/s
    double network;       ///< m
};

struct SimulatedRanges {
    RangingLog log;
    std::vector<RangingTruth> truth;  ///< one per epoch
};

/// Ranges at k/rate, k = 1, 2, ..., by the receiver's clock. Light time is iterated on the path and the orbits themselves, range
/// rates are differences of the ranges; none of the filter's row formulas is used. Each error has a separate random stream.
/// @throws Error(Input) that names the invalid setting.
[[nodiscard]] SimulatedRanges simulate_ranges(const RangingScenario& scenario, const TruthPath& path,
                                              const RangingSettings& settings);

/// The satellites' ranges as a receiver's log of code, Doppler and C/N0 in GPS time (`shift` is added to the epochs).
[[nodiscard]] gnss::ObservationLog observations_of(const RangingLog& ranges, Duration shift);

}  // namespace schuler::sim
