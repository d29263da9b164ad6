// Single samples far beyond all others: numbers that loggers write in place of a lost measurement.
#pragma once

#include <cstddef>
#include <vector>

namespace schuler::io {

inline constexpr double least_lonely_rate = 100.0;   ///< rad/s, beyond the range of all but special gyros
inline constexpr double least_lonely_force = 400.0;  ///< m/s^2

/// Indices, ascending, of samples above `least`, twenty times the 99th percentile and ten times both neighbours: no motion lasts
/// for a single sample. None if there are more than one in a hundred, which is the range of the log.
[[nodiscard]] std::vector<std::size_t> lonely_samples(const std::vector<double>& sizes, double least);

/// The two lists together, ascending, each index once.
[[nodiscard]] std::vector<std::size_t> either_of(const std::vector<std::size_t>& a, const std::vector<std::size_t>& b);

}  // namespace schuler::io
