// Ranges and ticks of plot axes.
#pragma once

#include "schuler/report/report.h"

#include <string>
#include <vector>

namespace schuler::report::detail {

/// Interval of an axis; empty (lo > hi) until a value has been included.
struct Range {
    double lo = 1.0, hi = -1.0;

    [[nodiscard]] bool empty() const { return lo > hi; }
    [[nodiscard]] double width() const { return hi - lo; }
    void take(double v);  ///< values that are not finite, or too large to be drawn, are ignored
};

struct Tick {
    double value;
    std::string label;
};

/// Ticks at 1, 2 or 5 times a power of ten, about `target` of them, with as many decimals as the step requires.
[[nodiscard]] std::vector<Tick> linear_ticks(Range range, double target);
/// Ticks at multiples of a step.
[[nodiscard]] std::vector<Tick> ticks_every(Range range, double step, int decimals);
/// Ticks at powers of ten (with 2 and 5 if there are few) of a range of log10 values; Tick::value is also log10.
[[nodiscard]] std::vector<Tick> log_ticks(Range log10_range);

/// x and y intervals that contain all the panel's data (for a panel with x limits, between them). A band is included from 5 % of
/// its length on: the uncertainty before the first measurement must not flatten the rest. With log_y the y interval is one of
/// log10 values. Empty without data.
struct DataRange {
    Range x, y;
};
[[nodiscard]] DataRange data_range(const Panel& panel);

}  // namespace schuler::report::detail
