// Order statistics.
#pragma once

#include <vector>

namespace schuler::math {

/// The p-quantile (0 to 1) of the finite values, nearest rank; NaN if there are none.
[[nodiscard]] double quantile(std::vector<double> values, double p);
[[nodiscard]] inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

}  // namespace schuler::math
