// Residuals of the base station at any time: its measurements minus those predicted from its known position.
#pragma once

#include "schuler/ppk/settings.h"
#include "schuler/ppk/tracking.h"

#include <optional>
#include <vector>

namespace schuler::ppk {

/// A signal at the base: measured minus modelled range, m: clocks, errors shared with the rover, ambiguity and noise.
struct BaseSignal {
    double code = not_given, phase = not_given;
    double code_factor = 1, phase_factor = 1;  ///< on the variance of a single measurement's noise, from interpolation
    double cn0 = not_given;
    int arc = 0;
    bool half_cycle = false, jumped = false;
};
struct BaseSatellite {
    SatelliteId id;
    gnss::Direction direction;
    std::array<BaseSignal, most_signals> signals;
};
struct BaseEpoch {
    std::vector<BaseSatellite> satellites;  ///< in the order of their ids
    double age = 0;                         ///< s to the nearer epoch of the base
    bool repeated = false;                  ///< its noise is also contained in neighbouring epochs of the rover
    double variance = 0;                    ///< m^2, of satellite clock variations since or between the epochs
};

/// A static base. Between two of its epochs the residuals are interpolated linearly: they vary with satellite clocks and the
/// atmosphere only. Before its first epoch, after its last and in gaps the nearest epoch is used as long as it is not too old.
class BaseStation {
public:
    BaseStation(const std::vector<TrackedEpoch>& epochs, const Ecef& position, const AirModel& air, const BaseSettings& settings);

    [[nodiscard]] std::optional<BaseEpoch> at(Time tag) const;
    [[nodiscard]] const Ecef& position() const { return position_; }
    [[nodiscard]] const Geodetic& geodetic() const { return geodetic_; }

private:
    struct Node {
        Time tag;
        std::vector<BaseSatellite> satellites;
    };
    [[nodiscard]] BaseEpoch between(const Node& a, const Node& b, Time tag) const;

    std::vector<Node> nodes_;
    Ecef position_;
    Geodetic geodetic_;
    BaseSettings settings_;
};

}  // namespace schuler::ppk
