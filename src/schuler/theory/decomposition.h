// A linear system with constant coefficients as the sum of its modes.
#pragma once

#include <Eigen/Core>

#include <complex>

namespace schuler::theory {

/// x(t) = constant + sum over the columns of part_i exp(root_i t) for dx/dt = F x + d.
struct Decomposition {
    Eigen::VectorXcd root;     ///< eigenvalues of F, 1/s, n
    Eigen::MatrixXcd vectors;  ///< eigenvectors of F of unit length, n x n, one a column
    Eigen::MatrixXcd part;     ///< n x n; column i: what mode i has of x at t = 0
    Eigen::VectorXd constant;  ///< n
};

/// F (n x n) and the state x and driving d (n) at t = 0. @throws Error(Computation) where the modes are not distinct.
[[nodiscard]] Decomposition decomposed(const Eigen::MatrixXd& F, const Eigen::VectorXd& x, const Eigen::VectorXd& d);

}  // namespace schuler::theory
