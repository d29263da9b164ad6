// Estimation before and beside the Kalman filter: chapter 2 of paper A as functions. Not for the hot path.
#pragma once

#include <Eigen/Core>

namespace schuler::estim {

struct Estimate {
    Eigen::VectorXd x;
    Eigen::MatrixXd P;  ///< covariance of its error
};

/// Least squares of y = A x + noise, every measurement alike; P from the residuals' variance (more measurements than unknowns) or, with
/// as many, zero. [PaperA:2] @throws Error(Input) where A has not full column rank.
[[nodiscard]] Estimate least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& y);

/// Maximum likelihood for normal noise of covariance R: least squares weighted by its inverse; P = (A^T R^-1 A)^-1. @throws likewise,
/// and where R is not positive definite.
[[nodiscard]] Estimate maximum_likelihood(const Eigen::MatrixXd& A, const Eigen::VectorXd& y, const Eigen::MatrixXd& R);

/// The same with a normal prior (the most probable x after y).
[[nodiscard]] Estimate maximum_a_posteriori(const Eigen::MatrixXd& A, const Eigen::VectorXd& y, const Eigen::MatrixXd& R,
                                            const Estimate& prior);

/// Mean of measurements one by one: m_n = m_(n-1) + (y_n - m_(n-1)) / n.
struct RecursiveMean {
    double mean = 0.0;
    long n = 0;
    void add(double y) { mean += (y - mean) / static_cast<double>(++n); }
};

/// Kalman filter of one unknown that walks with density q (unit^2/s), measured with variance r. [Kalman1960]
struct ScalarKalman {
    double x = 0.0, P = 0.0;
    double q = 0.0, r = 1.0;
    void predict(double dt) { P += q * dt; }
    /// Returns the gain.
    double update(double y);
};

}  // namespace schuler::estim
