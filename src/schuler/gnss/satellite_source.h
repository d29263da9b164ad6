// Where satellite positions come from: broadcast ephemerides chosen by time, or precise orbits.
#pragma once

#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/orbit.h"

#include <array>
#include <optional>
#include <vector>

namespace schuler::gnss {

/// A satellite as the model of a measurement needs it.
struct Transmitter {
    SatelliteState state;
    double group_delay = 0;  ///< s, of the signal asked for
    int channel = 0;         ///< GLONASS frequency number
};

/// Gives the satellite at the time of transmission.
class SatelliteSource {
public:
    virtual ~SatelliteSource() = default;
    /// Nothing where there is no valid ephemeris of a healthy satellite at `t`.
    [[nodiscard]] virtual std::optional<Transmitter> at(SatelliteId satellite, Signal signal, Time t) const = 0;
};

/// Broadcast ephemerides: the one whose reference time is nearest, of several with the same the one sent last; for Galileo I/NAV before
/// F/NAV. Valid so long after and before its reference: GPS, QZSS, NavIC half the fit interval (2 h), Galileo 4 h, BeiDou 6 h,
/// GLONASS 30 min, SBAS 6 min.
class BroadcastSource final : public SatelliteSource {
public:
    explicit BroadcastSource(Navigation navigation);
    [[nodiscard]] std::optional<Transmitter> at(SatelliteId satellite, Signal signal, Time t) const override;
    [[nodiscard]] const Navigation& navigation() const { return navigation_; }
    /// Satellites whose messages contradict each other: these are not used.
    [[nodiscard]] const std::vector<SatelliteId>& contradicting() const { return contradicting_; }
    /// The ephemeris that at() would use, healthy or not; null where none is valid.
    [[nodiscard]] const KeplerEphemeris* kepler(SatelliteId satellite, Time t) const;
    [[nodiscard]] const GlonassEphemeris* glonass(SatelliteId satellite, Time t) const;
    [[nodiscard]] const SbasEphemeris* sbas(SatelliteId satellite, Time t) const;

private:
    struct Range {
        std::size_t first = 0, last = 0;
    };
    Navigation navigation_;  ///< sorted by satellite and reference time
    std::array<Range, satellite_count> ranges_{};
    std::vector<SatelliteId> contradicting_;
};

/// Positions and clocks at regular epochs (SP3), interpolated: positions by a polynomial through eleven epochs in axes that do not
/// turn, clocks linearly. At 15 min spacing the interpolation error is below 2 cm for medium orbits, away from the file's ends.
class PreciseSource final : public SatelliteSource {
public:
    struct Node {
        Time time;
        Eigen::Vector3d position;  ///< m, Earth-fixed
        double clock;              ///< s, without relativity; NaN where unknown
    };
    /// Nodes of each satellite in order of time.
    explicit PreciseSource(std::vector<std::vector<Node>> nodes_by_satellite) : nodes_(std::move(nodes_by_satellite)) {
        nodes_.resize(satellite_count);
    }
    [[nodiscard]] std::optional<Transmitter> at(SatelliteId satellite, Signal signal, Time t) const override;

private:
    std::vector<std::vector<Node>> nodes_;
};

}  // namespace schuler::gnss
