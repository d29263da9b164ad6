// Order statistics insensitive to a few outliers.
#pragma once

#include "schuler/math/quantile.h"

#include <span>
#include <vector>

namespace schuler::inspect::detail {

using math::median;
using math::quantile;

/// 1.4826 times the median distance from the median: the standard deviation of a normal distribution. NaN if there are none.
[[nodiscard]] double robust_sigma(const std::vector<double>& values);

/// The minimum of a sampled curve by a parabola through the smallest sample and its neighbours. At an end of the curve the end
/// itself, with `inside` false.
struct Minimum {
    double at = 0.0;
    double value = 0.0;
    bool inside = false;
};
[[nodiscard]] Minimum lowest_point(double first, double step, std::span<const double> values);

/// Minimum of a sum of curves, one per independent interval of data, with the jackknife standard deviation over the intervals
/// (Efron and Stein, Ann. Statist. 9(3), 1981, eq. (1.4): omitting one interval at a time). Requires at least 3 intervals.
struct Agreement {
    double at = 0.0;
    double sigma = 0.0;
    double contrast = 0.0;  ///< (mean of the curve - its minimum) / minimum: depth of the minimum
    int stretches = 0;
    bool found = false;
    std::vector<double> rivals;  ///< further minima, hardly higher: of a periodic motion, a period away

    /// This minimum or the rival that is nearest to `expected`.
    [[nodiscard]] double nearest_to(double expected) const;
};
[[nodiscard]] Agreement agree(double first, double step, const std::vector<std::vector<double>>& curves);

}  // namespace schuler::inspect::detail
