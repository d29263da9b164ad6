// Covariance propagation with a dense transition matrix: for filters that propagate once per second.
#pragma once

#include <Eigen/Core>

namespace schuler::estim {

/// P <- Phi P Phi^T + Q, exactly symmetric. P and Q must be symmetric on entry.
template <int N>
void propagate(Eigen::Matrix<double, N, N>& P, const Eigen::Matrix<double, N, N>& Phi, const Eigen::Matrix<double, N, N>& Q) {
    Eigen::Matrix<double, N, N> half, whole;
    half.noalias() = Phi * P;
    whole.noalias() = half * Phi.transpose();
    P = 0.5 * (whole + whole.transpose()) + Q;
}

}  // namespace schuler::estim
