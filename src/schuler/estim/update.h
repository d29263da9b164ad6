// Sequential measurement update of a filter with states chosen at run time, one scalar at a time, and its adjoint for smoothing.
#pragma once

#include "schuler/estim/state.h"

#include <array>
#include <cstddef>

namespace schuler::estim {

/// A measurement row: innovation = h . error + noise. The first nine states, on which nearly every measurement depends, are dense, of
/// the others only those that it names.
struct Row {
    static constexpr int dense = 9;
    static constexpr int most = 36;

    Eigen::Matrix<double, dense, 1> head = Eigen::Matrix<double, dense, 1>::Zero();
    std::array<int, most> index{};
    std::array<double, most> value{};
    int count = 0;

    void add(int i, double x) {
        index[static_cast<std::size_t>(count)] = i;
        value[static_cast<std::size_t>(count++)] = x;
    }
    void add3(int first, const Eigen::Vector3d& x) {
        for (int i = 0; i < 3; ++i) add(first + i, x(i));
    }
    /// h . x.
    template <class Vector>
    [[nodiscard]] double dot(const Vector& x) const {
        double sum = head.dot(x.template head<dense>());
        for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) sum += value[k] * x(index[k]);
        return sum;
    }
    /// P h for the leading `used` states, zero beyond them.
    [[nodiscard]] StateVector times(const StateMatrix& P, int used) const;
    [[nodiscard]] double operator()(int i) const;
    /// All of it, for so many states.
    [[nodiscard]] StateVector whole(Eigen::Index size) const;
};

/// What one scalar update did: enough to undo it in the backward pass of the smoother.
struct RowUpdate {
    Row h;
    StateVector k;            ///< gain
    double innovation = 0.0;  ///< less h . dx of the scalars before it in the same epoch
    double s = 1.0;           ///< innovation variance h P h^T + r
};

/// Updates the estimated error dx and the leading `used` states of P with `innovation` = h . error + noise of variance r (all in the
/// measurement's unit), with the optimal gain: P - P h h^T P / s, Joseph's form expanded for that gain, which keeps P exactly symmetric.
RowUpdate update(StateVector& dx, StateMatrix& P, const Row& h, double innovation, double r, int used);

/// Many scalars of one epoch at once: what their updates one by one, in the order in which they were added, would find and do, by products
/// of blocks. The same numbers but for rounding.
class EpochUpdate {
public:
    static constexpr int most = 64;  ///< scalars

    /// P is kept by reference and stays as it is until `apply`. It does not change between the first `add` and `apply`.
    EpochUpdate(const StateMatrix& P, int used) : P_(P), used_(used) {}
    /// As if no scalar had been added.
    void reset() { count_ = 0; }
    /// One more scalar, as `update` has it.
    void add(const Row& h, double innovation, double r);
    /// Works all of them out, once; returns the error that they tell.
    StateVector solve();
    /// Of scalar k, after `solve`: what `update` would have returned for it.
    [[nodiscard]] double innovation(int k) const { return innovation_[static_cast<std::size_t>(k)]; }
    [[nodiscard]] double s(int k) const { return s_[static_cast<std::size_t>(k)]; }
    [[nodiscard]] RowUpdate result(const Row& h, int k) const;
    /// P after all of them; P is the matrix of the constructor.
    void apply(StateMatrix& P) const;

private:
    static constexpr int rows = max_states + most,
                         states_stride = most + 4;  // 4: columns of one state fall into different cache sets

    const StateMatrix& P_;
    int used_, count_ = 0;
    std::array<double, most> innovation_, s_;
    /// P H^T and below it (from row `used` on) the lower triangle of H P H^T; `solve` makes them G and L, with L L^T = H P H^T + R and
    /// G L^T = P H^T: the covariance is P - G G^T then. Column k of G is the gain of scalar k times the root of s.
    Eigen::Matrix<double, rows, most> G_;
    Eigen::Matrix<double, states_stride, max_states> by_state_;  // (P H^T)^T
};

/// Makes the states first, first + 1, first + 2 of P the combinations rows . x of the others, on which the rows must not depend.
void clone(StateMatrix& P, const std::array<Row, 3>& rows, int first, int used);

/// The leading `used` states of P after a correction with the gain k, whatever it is, by an innovation of variance s; ph is P h.
void correct_covariance(StateMatrix& P, const StateVector& k, const StateVector& ph, double s, int used);

/// The same as `update` with a gain that somebody else chose, in Joseph's form (I - k h) P (I - k h)^T + k r k^T: exact for any gain.
RowUpdate update_with_gain(StateVector& dx, StateMatrix& P, const Row& h, double innovation, double r, const StateVector& k,
                           int used);

/// Adjoint variables of the modified Bryson-Frazier smoother [Bierman1973]: the smoothed error at a time is -P lambda with
/// covariance P - P Lambda P, P being the filter's covariance there. Equal to the Rauch-Tung-Striebel smoother, without
/// inverting a covariance, so states without uncertainty are harmless.
struct StateAdjoint {
    StateVector lambda;
    StateMatrix Lambda;

    explicit StateAdjoint(int size) : lambda(StateVector::Zero(size)), Lambda(StateMatrix::Zero(size, size)) {}
    /// Steps backwards over a scalar update.
    void undo(const RowUpdate& u, int used);
    /// Steps backwards over `clone`: what is known of the clones later is known of what they were made of.
    void undo_clone(const std::array<Row, 3>& rows, int first);
    /// Steps backwards over the moment at which a state was given another meaning: what came before knows nothing of it.
    void forget(int state);
};

}  // namespace schuler::estim
