// Integers from real-valued ambiguities: integer least squares by decorrelation and search.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace schuler::ppk {

/// Integer least squares after a volume-preserving integer transformation z = Z' a that makes the ambiguities almost uncorrelated
/// [Teunissen1995]: their covariance is L' diag(d) L with L unit lower triangular, so that d[k] is the variance of z[k]
/// conditional on z[k+1] to the last. The last are known best.
struct Decorrelation {
    Eigen::MatrixXd Z;  ///< integers, determinant +-1
    Eigen::MatrixXd L;
    Eigen::VectorXd d;

    [[nodiscard]] Eigen::Index size() const { return d.size(); }
    /// The original ambiguities from z, exact for integers.
    [[nodiscard]] Eigen::VectorXd back(const Eigen::VectorXd& z) const;
};
/// Empty if the covariance (cycles^2) is not positive definite.
[[nodiscard]] std::optional<Decorrelation> decorrelate(const Eigen::MatrixXd& covariance);

/// Probability that sequential rounding, starting with the last, gives the correct integers for the last `count`; a lower bound
/// for integer least squares [Teunissen1999].
[[nodiscard]] double success_rate(const Decorrelation& decorrelation, Eigen::Index count);
/// The largest number of trailing elements whose success rate is at least `least`.
[[nodiscard]] Eigen::Index count_with_success(const Decorrelation& decorrelation, double least);

/// An integer vector and its squared distance from the real-valued one in the metric of the covariance.
struct IntegerCandidate {
    Eigen::VectorXd z;
    double distance = 0;
};
/// The `wanted` nearest vectors to the last `count` of z, the nearest first, by the shrinking search of [Chang2005]. Fewer,
/// possibly none, if it would visit more than `most_nodes`: the result is then undecided.
[[nodiscard]] std::vector<IntegerCandidate> nearest_integers(const Decorrelation& decorrelation, const Eigen::VectorXd& z,
                                                             Eigen::Index count, std::size_t wanted,
                                                             std::size_t most_nodes = 20'000);

}  // namespace schuler::ppk
