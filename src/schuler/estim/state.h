// Storage of a filter whose states are chosen at run time: of fixed size to avoid allocation, with a variable number of states in use.
#pragma once

#include <Eigen/Core>

namespace schuler::estim {

/// Capacity for the largest filter. A multiple of four, like every size used, so that columns consist of whole vectors.
inline constexpr int max_states = 128;

using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_states, 1>;
using StateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_states, max_states>;

/// Size of vectors and matrices for a number of states; padding states have zero covariance.
[[nodiscard]] constexpr int padded(int states) { return (states + 3) / 4 * 4; }

}  // namespace schuler::estim
