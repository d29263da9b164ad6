#include "schuler/inspect/detail/cadence.h"

#include "schuler/inspect/detail/robust.h"

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {

Cadence cadence_of(std::span<const double> times) {
    Cadence c;
    std::vector<double> starts, steps;
    starts.reserve(times.size());
    steps.reserve(times.size());
    bool first = true;
    double previous = 0.0;
    for (const double t : times) {
        if (!std::isfinite(t)) continue;
        ++c.rows;
        if (first) {
            c.start = c.stop = t;
            first = false;
        } else {
            const double step = t - previous;
            if (step > 0.0) {
                starts.push_back(previous);
                steps.push_back(step);
            } else if (step < 0.0) {
                ++c.backwards;
            } else {
                ++c.duplicates;
            }
        }
        c.start = std::min(c.start, t);
        c.stop = std::max(c.stop, t);
        previous = t;
    }
    if (steps.empty()) return c;
    c.step = median(steps);
    c.rate_hz = 1.0 / c.step;
    std::size_t odd = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double ratio = steps[i] / c.step;
        // 1e-6: an interval of exactly three steps in decimal notation is not a gap.
        if (ratio > 3.0 + 1e-6) c.gaps.push_back({starts[i], steps[i]});
        if (std::abs(ratio - 1.0) > 0.25) ++odd;
        if (ratio > 1.5) c.missing += static_cast<std::size_t>(std::min(std::llround(ratio) - 1, 1'000'000LL));
    }
    c.irregular = static_cast<double>(odd) / static_cast<double>(steps.size());
    return c;
}

}  // namespace schuler::inspect::detail
