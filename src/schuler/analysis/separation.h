// Two solutions of one log that have no measurement in common: their difference and its sigma.
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

/// Of one component over a span: NaN where there is nothing to count.
struct SeparationSpread {
    double rms = std::numeric_limits<double>::quiet_NaN();
    double inside_3sigma = std::numeric_limits<double>::quiet_NaN();  ///< share of the epochs
};

struct SeparationSummary {
    std::size_t epochs = 0;
    SeparationSpread north, east, up;  ///< m
    SeparationSpread heading;          ///< rad
};

/// Of the rows from `from` to `to`.
[[nodiscard]] SeparationSummary summarise(std::span<const SeparationRow> rows, Time from, Time to);

}  // namespace schuler::analysis
