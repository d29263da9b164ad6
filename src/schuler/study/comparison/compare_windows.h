// Windows of a comparison: the errors of a scheme inside them, and the time of recovery after them.
#pragma once

#include "schuler/settings/scenario/comparison.h"

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace schuler::study {

/// s, far below any period: equal times may differ by accumulation and rounding.
constexpr double same_instant = 1e-6;

/// Errors of a solution at its epochs of comparison, in ascending order of time.
struct ErrorCourse {
    std::vector<double> t;           ///< s from the start of the scenario
    std::vector<double> horizontal;  ///< m
    std::vector<double> vertical;    ///< m, absolute value
};

/// NaN: no values.
struct WindowStatistics {
    double horizontal_rms = std::numeric_limits<double>::quiet_NaN();  ///< m; without a solution there is no error
    double horizontal_max = std::numeric_limits<double>::quiet_NaN();  ///< m
    double vertical_max = std::numeric_limits<double>::quiet_NaN();    ///< m
    double share = std::numeric_limits<double>::quiet_NaN();           ///< of the instants inside with a recent solution
    double recovery = std::numeric_limits<double>::quiet_NaN();        ///< s, see window_statistics
    // For a receiver at correlator level, see add_signal_statistics.
    double held = std::numeric_limits<double>::quiet_NaN();  ///< dB-Hz
    double back = std::numeric_limits<double>::quiet_NaN();  ///< s
};

/// Errors inside a window; `solution` and `reference` are the times of both, ascending, s from the start of the scenario: the
/// reference times are the instants counted by the share.
///
/// An error is valid from its epoch to the next one, for at most `age`. Recovery is the least r >= 0 such that from r after the
/// window's end the error is valid and below the limit for `hold` without interruption: 0 if it was good at the end and stayed
/// so, NaN if the errors end before that is decided.
[[nodiscard]] WindowStatistics window_statistics(const settings::CompareWindow& window, const settings::WindowRules& rules,
                                                 const ErrorCourse& errors, std::span<const double> solution,
                                                 std::span<const double> reference);

/// The same curve with about that many points. Where a solution was missing for longer than `age` (s) it has a point of NaN errors.
[[nodiscard]] ErrorCourse drawn_course(const ErrorCourse& errors, double age, std::size_t points);

}  // namespace schuler::study
