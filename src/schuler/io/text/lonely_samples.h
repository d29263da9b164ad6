// Single samples far beyond all others: numbers that loggers write in place of a lost measurement.
#pragma once

#include <cstddef>
#include <vector>

namespace schuler::io {

/// Indices, ascending, of samples beyond the range of all but special instruments (100 rad/s or 400 m/s^2), twenty times the 99th
/// percentile and ten times both neighbours: no motion lasts for a single sample. None of rates or of forces if there are more than
/// one in a hundred, which is the range of the log.
/// @param rates, forces largest component of each sample, rad/s and m/s^2
[[nodiscard]] std::vector<std::size_t> lonely_samples(const std::vector<double>& rates, const std::vector<double>& forces);

}  // namespace schuler::io
