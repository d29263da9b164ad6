// Sequential measurement update, one scalar at a time, Joseph's form; and its adjoint for fixed-interval smoothing.
#pragma once

#include <Eigen/Core>

namespace schuler::estim {

/// What one scalar update did: enough to undo it in the backward pass of the smoother.
template <int N>
struct ScalarUpdate {
    Eigen::Matrix<double, N, 1> h;  ///< measurement row: innovation = h . error + noise
    Eigen::Matrix<double, N, 1> k;  ///< gain
    double innovation;              ///< computed minus measured, less h . dx of the scalars before it in the same epoch
    double s;                       ///< innovation variance h P h^T + r
};

/// Updates the estimated error dx and P with `innovation` = h . error + noise of variance r (all in the measurement's unit).
/// P is updated in Joseph's form (I - k h) P (I - k h)^T + k r k^T, written out for a scalar, and stays symmetric.
template <int N>
ScalarUpdate<N> update_scalar(Eigen::Matrix<double, N, 1>& dx, Eigen::Matrix<double, N, N>& P,
                              const Eigen::Matrix<double, N, 1>& h, double innovation, double r);

/// Adjoint variables of the modified Bryson-Frazier smoother [Bierman1973]: the smoothed error at a time is -P lambda with
/// covariance P - P Lambda P, P being the filter's covariance there. Equal to the Rauch-Tung-Striebel smoother, without
/// inverting a covariance, so states without uncertainty are harmless.
template <int N>
struct Adjoint {
    Eigen::Matrix<double, N, 1> lambda = Eigen::Matrix<double, N, 1>::Zero();
    Eigen::Matrix<double, N, N> Lambda = Eigen::Matrix<double, N, N>::Zero();

    /// Steps backwards over a scalar update.
    void undo(const ScalarUpdate<N>& u);
};

extern template struct Adjoint<7>;
extern template struct Adjoint<30>;

}  // namespace schuler::estim
