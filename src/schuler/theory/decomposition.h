// Solution of a linear system with constant coefficients as a sum of modes.
#pragma once

#include <Eigen/Core>

#include <complex>

namespace schuler::theory {

/// x(t) = constant + sum over the columns of part_i exp(root_i t) for dx/dt = F x + d.
struct Decomposition {
    Eigen::VectorXcd root;     ///< eigenvalues of F, 1/s, n
    Eigen::MatrixXcd vectors;  ///< unit eigenvectors of F, n x n, one per column
    Eigen::MatrixXcd part;     ///< n x n; column i: contribution of mode i to x at t = 0
    Eigen::VectorXd constant;  ///< n
};

/// F (n x n), state x and input d (n) at t = 0. @throws Error(Computation) if the modes are not distinct.
[[nodiscard]] Decomposition decomposed(const Eigen::MatrixXd& F, const Eigen::VectorXd& x, const Eigen::VectorXd& d);

}  // namespace schuler::theory
