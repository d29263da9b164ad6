// Sequential measurement update by scalars in Joseph form; and its adjoint for fixed-interval smoothing.
#pragma once

#include <Eigen/Core>

namespace schuler::estim {

/// Record of one scalar update, sufficient to undo it in the backward pass of the smoother.
template <int N>
struct ScalarUpdate {
    Eigen::Matrix<double, N, 1> h;  ///< measurement row: innovation = h . error + noise
    Eigen::Matrix<double, N, 1> k;  ///< gain
    double innovation;              ///< computed minus measured, less h . dx of the preceding scalars of the same epoch
    double s;                       ///< innovation variance h P h^T + r
};

/// Updates the estimated error dx and P with `innovation` = h . error + noise of variance r (all in the measurement's unit).
/// P is updated in Joseph form (I - k h) P (I - k h)^T + k r k^T, expanded for a scalar, and stays symmetric.
template <int N>
ScalarUpdate<N> update_scalar(Eigen::Matrix<double, N, 1>& dx, Eigen::Matrix<double, N, N>& P,
                              const Eigen::Matrix<double, N, 1>& h, double innovation, double r);

/// Adjoint variables of the modified Bryson-Frazier smoother [Bierman1973]: the smoothed error at an instant is -P lambda with
/// covariance P - P Lambda P, where P is the filter's covariance. Equivalent to the Rauch-Tung-Striebel smoother without
/// inversion of a covariance, so states without uncertainty are permitted.
template <int N>
struct Adjoint {
    Eigen::Matrix<double, N, 1> lambda = Eigen::Matrix<double, N, 1>::Zero();
    Eigen::Matrix<double, N, N> Lambda = Eigen::Matrix<double, N, N>::Zero();

    /// Backward step over a scalar update.
    void undo(const ScalarUpdate<N>& u);
};

extern template struct Adjoint<7>;
extern template struct Adjoint<30>;

}  // namespace schuler::estim
