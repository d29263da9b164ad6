// Precise mean velocity between two epochs from carrier phases.
#pragma once

#include "schuler/gnss/single_point.h"

#include <optional>
#include <span>
#include <vector>

namespace schuler::gnss {

struct PhaseVelocitySettings {
    double phase_sigma = 0.005;     ///< m, of the difference of two phases, multipath and atmosphere over the interval included
    double longest_interval = 5.0;  ///< s between the epochs
    double slip = 6.0;              ///< sigmas of a residual that means a cycle slip
};

/// Mean velocity over (time - interval, time].
struct PhaseVelocity {
    Eigen::Vector3d velocity;  ///< m/s, Earth-fixed
    Eigen::Matrix3d covariance;
    double interval = 0;  ///< s
    int used = 0;         ///< satellites
    int slips = 0;        ///< satellites left out because their phase jumped
};

/// Differences the phases of each satellite's first signal from epoch to epoch: what the satellite's motion, its clock and the
/// receiver's rough position explain is taken off, the rest is the receiver's displacement and clock change (math.md 5.3 for two epochs).
/// An error of the position of 10 m moves the velocity by 1 to 2 mm/s. Cycle slips: those the receiver tells, and residuals that do
/// not fit, the largest first.
class PhaseDifferences {
public:
    PhaseDifferences(const SatelliteSource& source, const RangeSettings& ranges, const PhaseVelocitySettings& settings = {})
        : source_(source), ranges_(ranges), settings_(settings) {}

    /// `solution` is the position of this epoch; an unsolved one starts anew. Nothing where there is no epoch before, too long ago,
    /// or too few satellites go on.
    [[nodiscard]] std::optional<PhaseVelocity> update(std::span<const SignalObservation> observations, Time tag,
                                                      const GlonassChannels& channels, const SinglePointSolution& solution);

private:
    /// One satellite's phase at one epoch, m, with its transmitter.
    struct Phase {
        SatelliteId satellite;
        Signal signal;
        double metres = 0;  ///< phase plus satellite clock
        bool lost = false;
        double elevation = 0;
        Range range;
    };
    [[nodiscard]] std::vector<Phase> phases(std::span<const SignalObservation> observations, Time tag,
                                            const GlonassChannels& channels, const SinglePointSolution& solution) const;

    const SatelliteSource& source_;
    RangeSettings ranges_;
    PhaseVelocitySettings settings_;
    std::vector<Phase> before_;
    Time time_before_;
};

}  // namespace schuler::gnss
