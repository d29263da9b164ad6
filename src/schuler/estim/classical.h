// Estimators other than the Kalman filter: chapter 2 of paper A as functions. Not for the hot path.
#pragma once

#include <Eigen/Core>

namespace schuler::estim {

struct Estimate {
    Eigen::VectorXd x;
    Eigen::MatrixXd P;  ///< covariance of the estimation error
};

/// Least squares for y = A x + noise with equal weights; P from the residual variance (more measurements than unknowns), or zero
/// (equal number). [PaperA:2] @throws Error(Input) if A does not have full column rank.
[[nodiscard]] Estimate least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& y);

/// Maximum likelihood for normal noise of covariance R: least squares weighted by its inverse; P = (A^T R^-1 A)^-1. Throws likewise,
/// and if R is not positive definite.
[[nodiscard]] Estimate maximum_likelihood(const Eigen::MatrixXd& A, const Eigen::VectorXd& y, const Eigen::MatrixXd& R);

/// The same with a normal prior (the most probable x given y).
[[nodiscard]] Estimate maximum_a_posteriori(const Eigen::MatrixXd& A, const Eigen::VectorXd& y, const Eigen::MatrixXd& R,
                                            const Estimate& prior);

/// Recursive mean of measurements: m_n = m_(n-1) + (y_n - m_(n-1)) / n.
struct RecursiveMean {
    double mean = 0.0;
    long n = 0;
    void add(double y) { mean += (y - mean) / static_cast<double>(++n); }
};

/// Kalman filter of one random-walk unknown of density q (unit^2/s), measured with variance r. [Kalman1960]
struct ScalarKalman {
    double x = 0.0, P = 0.0;
    double q = 0.0, r = 1.0;
    void predict(double dt) { P += q * dt; }
    /// Returns the gain.
    double update(double y);
};

}  // namespace schuler::estim
