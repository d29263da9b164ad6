// The binomial distribution: bounds on a probability from trials.
#pragma once

#include <array>
#include <cstddef>

namespace schuler::math {

/// Bounds of a probability given `events` in `trials` with confidence 0 < c < 1, exact (Clopper and Pearson 1934):
/// each tail has (1 - c) / 2. Throws Error(Input) if events exceed trials or c is out of range.
[[nodiscard]] std::array<double, 2> binomial_bounds(std::size_t events, std::size_t trials, double confidence);

}  // namespace schuler::math
