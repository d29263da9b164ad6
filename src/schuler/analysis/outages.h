// Performance of a solution in outages of a measurement source.
#pragma once

#include "schuler/analysis/errors.h"

#include <Eigen/Core>

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace schuler::analysis {

/// A source is withheld at start < t < start + duration.
struct OutageSpan {
    Time start;
    Duration duration;
};

/// Error at one reference epoch of an outage.
struct OutageError {
    Time time;
    Eigen::Vector3d error;  ///< estimate minus reference, east, north, up, m
    Eigen::Vector3d sigma;  ///< its stated one sigma, m
};

/// The `outages` of summary.json, m. NaN without a reference epoch.
struct OutageStatistics {
    OutageSpan span;
    std::size_t epochs = 0;
    std::size_t epochs_inside = 0;  ///< number of those with north and east within three sigma
    double end_horizontal = std::numeric_limits<double>::quiet_NaN();
    double max_horizontal = std::numeric_limits<double>::quiet_NaN();
    double growth_horizontal =
        std::numeric_limits<double>::quiet_NaN();                    ///< magnitude of the change from the first epoch to the end
    double end_vertical = std::numeric_limits<double>::quiet_NaN();  ///< absolute value
    double max_3d = std::numeric_limits<double>::quiet_NaN();
    bool inside_3sigma = false;  ///< north and east at every epoch
};

/// Statistics of the errors of one outage in time order, the last one at its end.
[[nodiscard]] OutageStatistics outage_statistics(const OutageSpan& span, std::span<const OutageError> errors);

/// Errors at the reference epochs inside an outage and at the first one at or after its end. There the solution is taken before
/// the source returned: with `updates_jump` (a forward solution) the first of two rows of the same time, or the last row before the
/// epoch extrapolated by its velocity; otherwise (smoothed) the solution itself.
[[nodiscard]] std::vector<OutageError> outage_errors(const earth::Earth& earth, std::span<const SolutionRow> rows,
                                                     std::span<const ReferenceSample> reference, const OutageSpan& span,
                                                     bool updates_jump, const ErrorOptions& options = {});

}  // namespace schuler::analysis
