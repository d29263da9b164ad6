// Storage of a filter whose states are chosen at run time: of fixed size to avoid allocation, with a variable number of states in use.
#pragma once

#include <Eigen/Core>

namespace schuler::estim {

/// Capacity for the largest filter. A multiple of four, like every size used, so that columns consist of whole vectors.
inline constexpr int max_states = 128;

/// Number type in which covariances are stored. Single precision only in the embedded core built with SCHULER_FLOAT32_COVARIANCE
/// (docs/embed.md); the arithmetic is in double precision in either case.
#ifdef SCHULER_FLOAT32_COVARIANCE
using CovarianceScalar = float;
#else
using CovarianceScalar = double;
#endif

using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_states, 1>;
using StateMatrix = Eigen::Matrix<CovarianceScalar, Eigen::Dynamic, Eigen::Dynamic, 0, max_states, max_states>;

/// A part of a covariance for arithmetic in double precision; for use within one expression.
template <class Part>
[[nodiscard]] decltype(auto) as_double(const Part& part) {
    return part.template cast<double>();
}

/// part += change; part: a part of a covariance.
template <class Part, class Change>
void add(Part&& part, const Change& change) {
    part = (as_double(part) + change).template cast<CovarianceScalar>();
}

/// part -= change.
template <class Part, class Change>
void subtract(Part&& part, const Change& change) {
    part = (as_double(part) - change).template cast<CovarianceScalar>();
}

/// Size of vectors and matrices for a number of states; padding states have zero covariance.
[[nodiscard]] constexpr int padded(int states) { return (states + 3) / 4 * 4; }

}  // namespace schuler::estim
