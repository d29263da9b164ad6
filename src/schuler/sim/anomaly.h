// Gravity disturbance along a track, for the simulation of gravimetric surveys.
#pragma once

#include "schuler/sim/path.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <vector>

namespace schuler::sim {

/// One part of the disturbance, a function of the distance along the track (m), or of time (s) if `by_time`.
struct AnomalyPart {
    enum class Kind {
        Constant,      ///< size
        Step,          ///< size from `start` on
        Ramp,          ///< from zero at `start` to size at `start` + `length`, then size
        Harmonic,      ///< size sin(2 pi (s - start)/length)
        GaussMarkov1,  ///< sigma size, correlation exp(-d/length)
        GaussMarkov2,  ///< sigma size, correlation (1 + d/length) exp(-d/length): smooth
    };
    Kind kind = Kind::Constant;
    Eigen::Vector3d size_n = Eigen::Vector3d::Zero();  ///< north, east, down, m/s^2
    double start = 0.0;
    double length = 1.0;
    bool by_time = false;
};

/// A field over the ground: north, east, down, m/s^2, at a position.
using GroundField = std::function<Eigen::Vector3d(const Geodetic&)>;

/// The sum of parts, and of a field under the path. Immutable; random parts are drawn once, at 64 points per correlation length,
/// with linear interpolation.
class AnomalyTrack {
public:
    /// extent: length of the track (m), duration (s). The same seed gives the same track; a part keeps its numbers when others
    /// are added after it. @throws Error(Input) that names the invalid value.
    AnomalyTrack(std::vector<AnomalyPart> parts, double extent, double duration, std::uint64_t seed);

    /// The same with a field, which is evaluated once per second along the path.
    AnomalyTrack(std::vector<AnomalyPart> parts, const GroundField& field, const TruthPath& path, double duration,
                 std::uint64_t seed);

    /// North, east, down, m/s^2. Beyond the extent random parts keep their last value.
    [[nodiscard]] Eigen::Vector3d at(double distance, double t) const;

private:
    struct Drawn {
        AnomalyPart part;
        std::vector<Eigen::Vector3d> values;  ///< of a random part
    };
    std::vector<Drawn> parts_;
    std::vector<Eigen::Vector3d> under_path_;  ///< of the field, at whole seconds; empty: none
};

/// Length of the path, m, from the speed over the ellipsoid once per second.
[[nodiscard]] double distance_along(const TruthPath& path, double duration);

}  // namespace schuler::sim
