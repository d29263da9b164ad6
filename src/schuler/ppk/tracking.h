// What one receiver tracked, epoch by epoch: code and phase of the signals that both receivers have, with the satellites that sent them.
#pragma once

#include "schuler/gnss/observation.h"
#include "schuler/gnss/single_point.h"

#include <array>
#include <optional>
#include <vector>

namespace schuler::ppk {

using gnss::SatelliteId;

inline constexpr std::size_t most_signals = 3;

/// A signal of one satellite as each receiver tracks it. Codes of different tracking modes have delays of their own.
struct SignalPair {
    gnss::Signal rover, base;
    [[nodiscard]] bool same() const { return rover == base; }
};

/// What is differenced between rover and base, by satellite.
struct SignalPlan {
    std::array<std::vector<SignalPair>, gnss::satellite_count> of;
    [[nodiscard]] std::size_t satellites() const;
};

/// Up to `frequencies` signals for each satellite of the systems wanted, on the carriers in order of preference, that both logs have phases
/// of; of several tracking modes on a carrier the one that both have most often.
[[nodiscard]] SignalPlan common_signals(const gnss::ObservationLog& rover, const gnss::ObservationLog& base,
                                        const gnss::RangeSettings& settings, std::size_t frequencies);

/// One signal. NaN where it was not measured.
struct TrackedSignal {
    double code = not_given;     ///< m
    double phase = not_given;    ///< m
    double doppler = not_given;  ///< m/s, range rate
    double wavelength = 0;       ///< m
    double cn0 = not_given;      ///< dB-Hz
    int arc = 0;                 ///< the phase counts on without a jump while this number stays; 0: no phase
    bool lost = false;           ///< the receiver says that it lost lock since the epoch before
    bool half_cycle = false;     ///< the receiver has not yet resolved half cycles
    bool jumped = false;         ///< the arc began with a jump that the receiver did not tell, of half cycles perhaps
};

/// One satellite at the time when what arrives now was sent.
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
    Ecef position;                     ///< the single-point solution; where there is none, the last one
    bool placed = false;               ///< there is a single-point solution
    gnss::SinglePointSolution single;  ///< without its satellites
    std::vector<TrackedSatellite> satellites;
};

enum class Side { Rover, Base };

/// Goes through a log. `fixed`: where the receiver stands, if it is at rest at a known place; then no single-point solution is computed.
/// Signals below the elevation mask or too weak are left out.
[[nodiscard]] std::vector<TrackedEpoch> tracked(const gnss::ObservationLog& log, Side side, const SignalPlan& plan,
                                                const gnss::SatelliteSource& source, gnss::SinglePoint& solver,
                                                const gnss::RangeSettings& settings, std::optional<Ecef> fixed);

/// Range from a satellite at its time of transmission to a receiver, with the Earth's rotation during the flight, m; and its gradient in the
/// receiver's position, the unit vector of the line of sight.
struct Line {
    double range = 0;
    Eigen::Vector3d towards{0, 0, 0};
    gnss::Direction direction;
};
[[nodiscard]] Line line_to(const TrackedSatellite& satellite, const Ecef& receiver, const Geodetic& geodetic);

}  // namespace schuler::ppk
