// Windows of a comparison: what the errors of a scheme are inside them, and how long after them it takes to be good again.
#pragma once

#include "schuler/settings/scenario/comparison.h"

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace schuler::study {

/// s, far below any period: equal times may differ by sums and roundings.
constexpr double same_instant = 1e-6;

/// Errors of a solution at the epochs it is compared at, in ascending order of time.
struct ErrorCourse {
    std::vector<double> t;           ///< s from the start of the scenario
    std::vector<double> horizontal;  ///< m
    std::vector<double> vertical;    ///< m, absolute value
};

/// NaN: nothing to count.
struct WindowStatistics {
    double horizontal_rms = std::numeric_limits<double>::quiet_NaN();  ///< m; where there is no solution there is no error
    double horizontal_max = std::numeric_limits<double>::quiet_NaN();  ///< m
    double vertical_max = std::numeric_limits<double>::quiet_NaN();    ///< m
    double share = std::numeric_limits<double>::quiet_NaN();           ///< of the instants inside with a solution not too old
    double recovery = std::numeric_limits<double>::quiet_NaN();        ///< s, see window_statistics
    // Of a receiver at correlator level, see add_signal_statistics.
    double held = std::numeric_limits<double>::quiet_NaN();  ///< dB-Hz
    double back = std::numeric_limits<double>::quiet_NaN();  ///< s
};

/// Errors inside a window; `solution` and `reference` are the times of both, ascending, s from the start of the scenario: the
/// reference's are the instants that the share counts.
///
/// An error holds from its epoch to the next one, for `age` at the most. Recovery is the least r >= 0 such that from r after the
/// window's end the error holds and is below the limit for `hold` without a break: 0 where it was good at the end and stayed so,
/// NaN where the errors end before that is decided.
[[nodiscard]] WindowStatistics window_statistics(const settings::CompareWindow& window, const settings::WindowRules& rules,
                                                 const ErrorCourse& errors, std::span<const double> solution,
                                                 std::span<const double> reference);

/// The same curve with about that many points. Where a solution was missing for longer than `age` (s) it has a point of NaN errors.
[[nodiscard]] ErrorCourse drawn_course(const ErrorCourse& errors, double age, std::size_t points);

}  // namespace schuler::study
