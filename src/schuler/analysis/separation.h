// Two solutions of one log without common measurements: their difference and its sigma.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"

#include <limits>
#include <span>
#include <vector>

namespace schuler::analysis {

/// Forward minus backward; sigmas are the roots of the sums of both variances.
struct SeparationRow {
    Time time;
    Eigen::Vector3d position, std_position;  ///< north, east, down, m
    Eigen::Vector3d velocity, std_velocity;  ///< m/s
    Eigen::Vector3d rpy, std_rpy;            ///< roll, pitch, heading, each in (-pi, pi], rad
};

/// At the times of both, in order.
[[nodiscard]] std::vector<SeparationRow> separation(const earth::Earth& earth, std::span<const SolutionRow> forward,
                                                    std::span<const SolutionRow> backward);

/// For one component over an interval: NaN if there are no values.
struct SeparationSpread {
    double rms = std::numeric_limits<double>::quiet_NaN();
    double inside_3sigma = std::numeric_limits<double>::quiet_NaN();  ///< fraction of the epochs
};

struct SeparationSummary {
    std::size_t epochs = 0;
    SeparationSpread north, east, up;  ///< m
    SeparationSpread heading;          ///< rad
};

/// Of the rows from `from` to `to`.
[[nodiscard]] SeparationSummary summarise(std::span<const SeparationRow> rows, Time from, Time to);

}  // namespace schuler::analysis
