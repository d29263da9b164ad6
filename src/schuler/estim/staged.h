// A large filter of which only a few states are driven at the rate of the inertial unit: their transition and noise are gathered over
// many small steps, and the large covariance is brought up to date only when a measurement or an output wants it. The result is that of
// propagating the whole at every step.
#pragma once

#include "schuler/estim/transition.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>

namespace schuler::estim {

/// Product of the transitions since the last renewal, for N states of the shape of Transition<N>.
template <int N>
struct GatheredTransition {
    Transition<N> phi;

    GatheredTransition() { reset(); }
    void reset() {
        phi.rows.setZero();
        phi.diagonal.setOnes();
        for (int i = 0; i < Transition<N>::coupled; ++i) phi.rows(i, i) = 1.0;
    }
    /// phi <- step phi.
    void then(const Transition<N>& step) {
        constexpr int m = Transition<N>::coupled;
        const Eigen::Matrix<double, N, m> before = phi.rows;
        phi.rows.noalias() = before * step.rows.template topRows<m>();
        phi.rows.template bottomRows<N - m>() +=
            phi.diagonal.template tail<N - m>().asDiagonal() * step.rows.template bottomRows<N - m>();
        phi.diagonal = phi.diagonal.cwiseProduct(step.diagonal);
    }
};

/// P <- Phi P Phi^T + Q for M states: the first N by `gathered` with the noise Q they gathered, the others by their own factors
/// `decay` (entries N.. are used) and noise `q`. P symmetric on entry and on return.
template <int M, int N>
void propagate_staged(Eigen::Matrix<double, M, M>& P, const GatheredTransition<N>& gathered, const Eigen::Matrix<double, N, N>& Q,
                      const Eigen::Matrix<double, M, 1>& decay, const Eigen::Matrix<double, M, 1>& q) {
    constexpr int m = Transition<N>::coupled;
    const auto& A = gathered.phi.rows;   // N x m, transposed rows
    Eigen::Matrix<double, M, 1> factor = decay;
    factor.template head<N>() = gathered.phi.diagonal;
    // rows of Phi P: the coupled ones by A, the others by their factor
    Eigen::Matrix<double, M, m> columns;   // (A P_top)^T, P being symmetric
    columns.noalias() = P.template leftCols<N>() * A;
    Eigen::Matrix<double, m, m> corner;
    corner.noalias() = A.transpose() * columns.template topRows<N>();
    for (int c = m; c < M; ++c) P.col(c) = factor(c) * P.col(c).cwiseProduct(factor);
    columns.template bottomRows<M - m>() = factor.template tail<M - m>().asDiagonal() * columns.template bottomRows<M - m>();
    P.template bottomLeftCorner<M - m, m>() = columns.template bottomRows<M - m>();
    P.template topRightCorner<m, M - m>() = columns.template bottomRows<M - m>().transpose();
    P.template topLeftCorner<m, m>() = 0.5 * (corner + corner.transpose());
    P.template topLeftCorner<N, N>() += Q;
    P.diagonal() += q;
}

/// A measurement row with few entries: innovation = sum of value . error + noise of variance r.
template <int Most>
struct SparseRow {
    std::array<int, Most> index{};
    std::array<double, Most> value{};
    int count = 0;

    void add(int i, double x) {
        index[static_cast<std::size_t>(count)] = i;
        value[static_cast<std::size_t>(count++)] = x;
    }
    template <class Vector>
    [[nodiscard]] double dot(const Vector& x) const {
        double sum = 0.0;
        for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) sum += value[k] * x(index[k]);
        return sum;
    }
};

/// What one update did.
struct SparseUpdate {
    double innovation = 0;   ///< less what the scalars before it in the epoch explain
    double s = 1;            ///< its variance
};

/// Sequential update of dx and the leading `used` (a multiple of 4) states of P by one sparse row, with the optimal gain: P - P h h^T P/s,
/// written so that P stays exactly symmetric (Joseph's form expanded for the optimal gain).
template <int M, int Most>
SparseUpdate update_sparse(Eigen::Matrix<double, M, 1>& dx, Eigen::Matrix<double, M, M>& P, const SparseRow<Most>& h,
                           double innovation, double r, int used = M) {
    Eigen::Matrix<double, M, 1> ph = Eigen::Matrix<double, M, 1>::Zero();
    for (std::size_t k = 0; k < static_cast<std::size_t>(h.count); ++k) ph.head(used) += h.value[k] * P.col(h.index[k]).head(used);
    SparseUpdate u;
    u.s = h.dot(ph) + r;
    u.innovation = innovation - h.dot(dx);
    dx += (u.innovation / u.s) * ph;
    ph *= 1.0 / std::sqrt(u.s);
    for (int c = 0; c < used; ++c) {
        const double pc = ph(c);
        if (pc != 0.0) P.col(c).head(used) -= pc * ph.head(used);
    }
    return u;
}

}  // namespace schuler::estim
