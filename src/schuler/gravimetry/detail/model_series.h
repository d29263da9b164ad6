// F of the model along a steady motion as Taylor series, in scaled states and time.
#pragma once

#include "schuler/gravimetry/detail/series.h"
#include "schuler/gravimetry/observability.h"

#include <vector>

namespace schuler::gravimetry::detail {

/// A non-zero element of F.
struct SeriesEntry {
    int row, column;
    Series value;
};
struct ModelSeries {
    std::vector<SeriesEntry> F;
    std::array<double, Observability::most> scale;  ///< a state in SI units = its scaled number times this
    double time_scale;                              ///< s
};

[[nodiscard]] ModelSeries model_series(const earth::Earth& earth, const ObservedMotion& motion);

}  // namespace schuler::gravimetry::detail
