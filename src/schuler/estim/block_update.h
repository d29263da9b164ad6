// Measurement update with many rows of mutually correlated noise, and tests for rows that do not fit.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace schuler::estim {

/// Innovation z = H . error + noise of covariance R, against a covariance P of any size.
class BlockUpdate {
public:
    BlockUpdate(const Eigen::MatrixXd& P, const Eigen::MatrixXd& H, const Eigen::VectorXd& z, const Eigen::MatrixXd& R);

    /// False if the innovation covariance is not positive definite: no other member may be called then.
    [[nodiscard]] bool valid() const { return valid_; }
    /// z' S^-1 z, chi-square with one degree of freedom per row.
    [[nodiscard]] double statistic() const { return whitened_.squaredNorm(); }
    /// Estimated bias in direction c of the innovation, in sigmas; standard normal if there is no bias [Baarda1968].
    [[nodiscard]] double standardised(const Eigen::VectorXd& c) const;
    /// The error estimated from the measurements.
    [[nodiscard]] Eigen::VectorXd error() const { return gain_root_.transpose() * whitened_; }
    /// Updates the covariance, which stays symmetric.
    void apply(Eigen::MatrixXd& P) const;

private:
    Eigen::LLT<Eigen::MatrixXd> root_;
    Eigen::MatrixXd gain_root_;  ///< L^-1 H P, with L L' = S
    Eigen::VectorXd whitened_;   ///< L^-1 z
    bool valid_ = false;
};

}  // namespace schuler::estim
