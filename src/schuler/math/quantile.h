// Order statistics.
#pragma once

#include <span>
#include <utility>
#include <vector>

namespace schuler::math {

/// The p-quantile (0 to 1) of the finite values, by nearest rank; NaN if there are none.
[[nodiscard]] double quantile(std::vector<double> values, double p);
/// The same for values in ascending order, linear between ranks; at least one value is required.
[[nodiscard]] double quantile_of_sorted(std::span<const double> sorted, double p);
[[nodiscard]] inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

}  // namespace schuler::math
