// Tracked data of one receiver by epoch: code and phase of the signals that both receivers have, with the transmitting satellites.
#pragma once

#include "schuler/gnss/antenna.h"
#include "schuler/gnss/observation.h"
#include "schuler/gnss/single_point.h"

#include <array>
#include <optional>
#include <vector>

namespace schuler::ppk {

using gnss::SatelliteId;

inline constexpr std::size_t most_signals = 3;

/// A signal of one satellite as tracked by each receiver. Codes of different tracking modes have different delays.
struct SignalPair {
    gnss::Signal rover, base;
    [[nodiscard]] bool same() const { return rover == base; }
};

/// Signals differenced between rover and base, by satellite.
struct SignalPlan {
    std::array<std::vector<SignalPair>, gnss::satellite_count> of;
    [[nodiscard]] std::size_t satellites() const;
};

/// Up to `frequencies` signals for each satellite of the selected systems, on the carriers in order of preference, with phases in
/// both logs; of several tracking modes on a carrier the one most frequent in both.
[[nodiscard]] SignalPlan common_signals(const gnss::ObservationLog& rover, const gnss::ObservationLog& base,
                                        const gnss::RangeSettings& settings, std::size_t frequencies);

/// One signal. NaN if not measured.
struct TrackedSignal {
    double code = not_given;     ///< m
    double phase = not_given;    ///< m
    double doppler = not_given;  ///< m/s, range rate
    double wavelength = 0;       ///< m
    double cn0 = not_given;      ///< dB-Hz
    int arc = 0;                 ///< unchanged while the phase is continuous; 0: no phase
    bool lost = false;           ///< loss of lock since the previous epoch, flagged by the receiver
    bool half_cycle = false;     ///< the receiver has not yet resolved half cycles
    bool jumped = false;         ///< the arc started with a jump not flagged by the receiver, possibly of half cycles
};

/// One satellite at the time of transmission of the signal received now.
struct TrackedSatellite {
    SatelliteId id;
    Time transmit;
    Ecef position;  ///< in Earth-fixed axes of that instant
    Eigen::Vector3d velocity{0, 0, 0};
    double clock = 0;       ///< m, satellite minus system time
    double clock_rate = 0;  ///< m/s
    double variance = 0;    ///< m^2, of orbit and clock
    gnss::Direction direction;
    std::array<TrackedSignal, most_signals> signals;  ///< in the order of the plan
};

struct TrackedEpoch {
    Time tag;                          ///< by the receiver's clock
    Time time;                         ///< GPS time
    Ecef position;                     ///< the single-point solution; if there is none, the last one
    bool placed = false;               ///< a single-point solution exists
    gnss::SinglePointSolution single;  ///< without its satellites
    std::vector<TrackedSatellite> satellites;
};

enum class Side { Rover, Base };

/// The receiver that a log is of.
struct Receiver {
    Side side = Side::Rover;
    std::optional<Ecef> fixed;               ///< its position, if it is at rest at a known point
    const gnss::Antenna* antenna = nullptr;  ///< calibrated: the measurements then refer to its reference point
};

/// Processes a log; of a fixed receiver no single-point solution is computed. Signals below the elevation mask or too weak are
/// excluded.
[[nodiscard]] std::vector<TrackedEpoch> tracked(const gnss::ObservationLog& log, const Receiver& receiver, const SignalPlan& plan,
                                                const gnss::SatelliteSource& source, gnss::SinglePoint& solver,
                                                const gnss::RangeSettings& settings);

/// Range from a satellite at its time of transmission to a receiver, including the Earth's rotation during the light time, m; and
/// its gradient with respect to the receiver position, the unit vector of the line of sight.
struct Line {
    double range = 0;
    Eigen::Vector3d towards{0, 0, 0};
    gnss::Direction direction;
};
[[nodiscard]] Line line_to(const TrackedSatellite& satellite, const Ecef& receiver, const Geodetic& geodetic);

}  // namespace schuler::ppk
