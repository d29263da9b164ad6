// Storage of a filter whose states are chosen at run time: fixed storage, so that nothing is allocated, and as many states as are used.
#pragma once

#include <Eigen/Core>

namespace schuler::estim {

/// Room for the largest filter. A multiple of four, as every size is: columns are whole vectors.
inline constexpr int max_states = 104;

using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_states, 1>;
using StateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_states, max_states>;

/// The size of vectors and matrices for so many states; what is beyond them has zero covariance.
[[nodiscard]] constexpr int padded(int states) { return (states + 3) / 4 * 4; }

}  // namespace schuler::estim
