// The binomial distribution: what trials say of a probability.
#pragma once

#include <array>
#include <cstddef>

namespace schuler::math {

/// Lower and upper bound of a probability after `events` in `trials` with confidence 0 < c < 1, exact (Clopper and Pearson 1934):
/// either tail has (1 - c) / 2. Throws Error(Input) where events exceed trials or c is outside.
[[nodiscard]] std::array<double, 2> binomial_bounds(std::size_t events, std::size_t trials, double confidence);

}  // namespace schuler::math
