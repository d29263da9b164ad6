// Measurement update with many rows at once whose noises are correlated, and tests of what in them does not fit.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace schuler::estim {

/// Innovation z = H . error + noise of covariance R, against a covariance P of any size.
class BlockUpdate {
public:
    BlockUpdate(const Eigen::MatrixXd& P, const Eigen::MatrixXd& H, const Eigen::VectorXd& z, const Eigen::MatrixXd& R);

    /// False where the innovation covariance is not positive definite: nothing else may be asked then.
    [[nodiscard]] bool valid() const { return valid_; }
    /// z' S^-1 z, chi-square with as many degrees of freedom as rows.
    [[nodiscard]] double statistic() const { return whitened_.squaredNorm(); }
    /// Size in sigmas of a bias of the direction c in the innovation, standard normal without one [Baarda1968].
    [[nodiscard]] double standardised(const Eigen::VectorXd& c) const;
    /// The error that the measurements tell.
    [[nodiscard]] Eigen::VectorXd error() const { return gain_root_.transpose() * whitened_; }
    /// The covariance afterwards, symmetric.
    void apply(Eigen::MatrixXd& P) const;

private:
    Eigen::LLT<Eigen::MatrixXd> root_;
    Eigen::MatrixXd gain_root_;  ///< L^-1 H P, with L L' = S
    Eigen::VectorXd whitened_;   ///< L^-1 z
    bool valid_ = false;
};

}  // namespace schuler::estim
