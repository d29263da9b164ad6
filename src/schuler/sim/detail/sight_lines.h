// Lines of sight from the moving antenna to every transmitter: shared by the simulated ranges and the simulated signals.
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

/// A geometric range with its transmitter.
struct SightLine {
    double range = 0;  ///< m, including light time and atmospheric delays
    gnss::SatelliteState transmitter;
    gnss::Direction direction;
};

/// Holds references to its arguments. Times are seconds of the scenario.
class SightLines {
public:
    /// Throws Error(Input) that names the invalid antenna or error setting.
    SightLines(const RangingScenario& scenario, const TruthPath& path, const RangingSettings& settings);

    /// Satellites of the navigation data, then stations.
    [[nodiscard]] const std::vector<Transmitter>& transmitters() const { return transmitters_; }
    /// To the antenna at `t`, light time iterated; empty if there is no such satellite.
    [[nodiscard]] std::optional<SightLine> to(const Transmitter& transmitter, double t) const;
    /// According to Masks::throughout.
    [[nodiscard]] bool allowed(const Transmitter& transmitter) const;
    /// Stations have no masks.
    [[nodiscard]] bool above_masks(const Transmitter& transmitter, const SightLine& line, double t) const;
    /// Blocked, or beyond the limit of satellites.
    [[nodiscard]] bool silent(const Transmitter& transmitter, double t) const;

private:
    /// @throws Error(Input) with this key if no source has this name.
    void require_source(const char* key, const std::string& name) const;

    struct Antenna {
        Ecef position;
        Geodetic place;
        Eigen::Vector3d up_e;  ///< normal of the antenna's plane
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
