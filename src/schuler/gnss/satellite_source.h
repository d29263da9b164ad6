// Sources of satellite positions: broadcast ephemerides selected by time, or precise orbits.
#pragma once

#include "schuler/gnss/antenna.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/orbit.h"

#include <array>
#include <optional>
#include <vector>

namespace schuler::gnss {

/// A satellite as required by the measurement model.
struct Transmitter {
    SatelliteState state;
    double group_delay = 0;  ///< s, of the requested signal
    int channel = 0;         ///< GLONASS frequency number
};

/// Provides the satellite state at the time of transmission.
class SatelliteSource {
public:
    virtual ~SatelliteSource() = default;
    /// Empty if there is no valid ephemeris of a healthy satellite at `t`.
    [[nodiscard]] virtual std::optional<Transmitter> at(SatelliteId satellite, Signal signal, Time t) const = 0;
};

/// Broadcast ephemerides: the one with the nearest reference time, of equals the one transmitted last; for Galileo I/NAV before
/// F/NAV. Valid this long before and after the reference: GPS, QZSS, NavIC half the fit interval (2 h), Galileo 4 h, BeiDou 6 h,
/// GLONASS 30 min, SBAS 6 min.
class BroadcastSource final : public SatelliteSource {
public:
    explicit BroadcastSource(Navigation navigation);
    [[nodiscard]] std::optional<Transmitter> at(SatelliteId satellite, Signal signal, Time t) const override;
    [[nodiscard]] const Navigation& navigation() const { return navigation_; }
    /// Satellites with contradictory messages, which are not used.
    [[nodiscard]] const std::vector<SatelliteId>& contradicting() const { return contradicting_; }
    /// The ephemeris used by at(), healthy or not; null if none is valid.
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

/// Positions and clocks at regular epochs (SP3), interpolated: positions by a polynomial through eleven epochs in non-rotating
/// axes, clocks linearly. At 15 min spacing the interpolation error is below 2 cm for medium orbits, except near the file's ends.
class PreciseSource final : public SatelliteSource {
public:
    struct Node {
        Time time;
        Eigen::Vector3d position;  ///< m, Earth-fixed
        double clock;              ///< s, without the relativistic term; NaN if unknown
    };
    /// Nodes of each satellite in time order, of the centres of mass; of satellites whose antenna is given, positions are those of the phase centres, of
    /// others the difference is in the variance.
    explicit PreciseSource(std::vector<std::vector<Node>> nodes_by_satellite, Antennas antennas = {})
        : nodes_(std::move(nodes_by_satellite)), antennas_(std::move(antennas)) {
        nodes_.resize(satellite_count);
    }
    [[nodiscard]] std::optional<Transmitter> at(SatelliteId satellite, Signal signal, Time t) const override;

private:
    std::vector<std::vector<Node>> nodes_;
    Antennas antennas_;
};

}  // namespace schuler::gnss
