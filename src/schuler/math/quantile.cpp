#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::math {

double quantile(std::vector<double> values, double p) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const double rank = std::clamp(p, 0.0, 1.0) * static_cast<double>(values.size() - 1);
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::lround(rank));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

}  // namespace schuler::math
