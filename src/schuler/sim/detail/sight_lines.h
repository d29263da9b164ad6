// From the antenna on its path to every transmitter: what the simulated ranges and the simulated signals share.
#pragma once

#include "schuler/gnss/atmosphere.h"
#include "schuler/gnss/satellite_source.h"
#include "schuler/sim/ranging.h"

#include <optional>
#include <string>
#include <vector>

namespace schuler::sim::detail {

/// A satellite, or a ground station.
struct Transmitter {
    std::string name;
    std::optional<gnss::SatelliteId> satellite;
    Ecef station;
    Geodetic station_place;
};

/// A geometric range with the transmitter that belongs to it.
struct SightLine {
    double range = 0;  ///< m, light time included, delays of the atmosphere too
    gnss::SatelliteState transmitter;
    gnss::Direction direction;
};

/// Refers to its arguments. Times are seconds of the scenario.
class SightLines {
public:
    /// Throws Error(Input) naming the setting of the antenna or of the errors that is unusable.
    SightLines(const RangingScenario& scenario, const TruthPath& path, const RangingSettings& settings);

    /// Satellites of the navigation data, then stations.
    [[nodiscard]] const std::vector<Transmitter>& transmitters() const { return transmitters_; }
    /// To the antenna at `t`, light time iterated; nothing where there is no such satellite.
    [[nodiscard]] std::optional<SightLine> to(const Transmitter& transmitter, double t) const;
    /// By Masks::throughout.
    [[nodiscard]] bool allowed(const Transmitter& transmitter) const;
    /// Stations have no masks.
    [[nodiscard]] bool above_masks(const Transmitter& transmitter, const SightLine& line, double t) const;
    /// Blocked, or one too many.
    [[nodiscard]] bool silent(const Transmitter& transmitter, double t) const;

private:
    struct Antenna {
        Ecef position;
        Geodetic place;
        Eigen::Vector3d up_e;  ///< out of the antenna's plane
    };
    [[nodiscard]] Antenna antenna(double t) const;
    [[nodiscard]] Time gps(double t) const { return s_.gps + Duration::from_seconds(t); }
    void choose_throughout();
    void choose_four();

    const RangingScenario& s_;
    const TruthPath& path_;
    const RangingSettings& r_;
    gnss::BroadcastSource orbits_;
    std::optional<gnss::KlobucharCoefficients> klobuchar_;
    std::vector<Transmitter> transmitters_;
    std::vector<gnss::SatelliteId> allowed_, by_height_, four_;
};

}  // namespace schuler::sim::detail
