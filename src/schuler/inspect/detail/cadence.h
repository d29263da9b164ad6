// Timing of a channel: rate, gaps, duplicates, backward steps.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace schuler::inspect::detail {

struct Gap {
    double start;   ///< time of the last sample before it, s
    double length;  ///< s
};

struct Cadence {
    std::size_t rows = 0;
    double rate_hz = 0.0;            ///< 1 / median step; 0 if there are fewer than two different times
    double step = 0.0;               ///< median of the positive steps, s
    double start = 0.0, stop = 0.0;  ///< earliest and latest, s
    std::vector<Gap> gaps;           ///< steps longer than 3 times the median, in order
    std::size_t duplicates = 0;      ///< steps of zero
    std::size_t backwards = 0;       ///< negative steps
    double irregular = 0.0;          ///< fraction of the steps that differ from the median by more than a quarter of it
    std::size_t missing = 0;         ///< number of samples missing relative to the median step (gaps included)
};

/// Times in s, in the order of the file. Values that are not finite are skipped.
[[nodiscard]] Cadence cadence_of(std::span<const double> times);

}  // namespace schuler::inspect::detail
