// Sequential scalar measurement update of a filter with states chosen at run time, and its adjoint for smoothing.
#pragma once

#include "schuler/estim/state.h"

#include <array>
#include <cstddef>

namespace schuler::estim {

/// A measurement row: innovation = h . error + noise. The first nine elements, used by nearly every measurement, are dense; of
/// the others only the named ones are stored.
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
    /// P h for the leading `used` states, zero for the others.
    [[nodiscard]] StateVector times(const StateMatrix& P, int used) const;
    [[nodiscard]] double operator()(int i) const;
    /// The complete row for the given number of states.
    [[nodiscard]] StateVector whole(Eigen::Index size) const;
};

namespace detail {

/// The entries of a row that are not zero.
struct RowEntries {
    std::array<int, Row::dense + Row::most> state;
    std::array<double, Row::dense + Row::most> value;
    std::size_t count = 0;

    void assign(const Row& h) {
        count = 0;
        for (int i = 0; i < Row::dense; ++i) add(i, h.head(i));
        for (std::size_t k = 0; k < static_cast<std::size_t>(h.count); ++k) add(h.index[k], h.value[k]);
    }
    void add(int i, double x) {
        if (x == 0.0) return;
        state[count] = i;
        value[count++] = x;
    }
};

}  // namespace detail

/// Record of one scalar update, sufficient to undo it in the backward pass of the smoother.
struct RowUpdate {
    Row h;
    StateVector k;            ///< gain
    double innovation = 0.0;  ///< less h . dx of the preceding scalars of the same epoch
    double s = 1.0;           ///< innovation variance h P h^T + r
};

/// Updates the estimated error dx and the leading `used` states of P with `innovation` = h . error + noise of variance r (all in the
/// measurement's unit), with the optimal gain: P - P h h^T P / s, the Joseph form for that gain, which keeps P exactly symmetric.
RowUpdate update(StateVector& dx, StateMatrix& P, const Row& h, double innovation, double r, int used);

/// Many scalars of one epoch processed together with block products: the result of their sequential updates in the order in which they
/// were added, except for rounding.
class EpochUpdate {
public:
    static constexpr int most = 64;  ///< scalars

    /// P is held by reference. It must not change between the first `add` and `apply`, which updates it.
    EpochUpdate(const StateMatrix& P, int used) : P_(P), used_(used) {}
    /// Discards the added scalars.
    void reset() { count_ = 0; }
    /// Adds one scalar, with the arguments of `update`.
    void add(const Row& h, double innovation, double r);
    /// Solves for all of them, once; returns the estimated error.
    StateVector solve();
    /// For scalar k, after `solve`: the value that `update` would have returned.
    [[nodiscard]] double innovation(int k) const { return innovation_[static_cast<std::size_t>(k)]; }
    [[nodiscard]] double s(int k) const { return s_[static_cast<std::size_t>(k)]; }
    [[nodiscard]] RowUpdate result(const Row& h, int k) const;
    /// Updates P for all scalars; P is the matrix of the constructor.
    void apply(StateMatrix& P) const;

private:
    /// Scalars first to first + 3 have been added: their rows of by_state_ and of H P H^T.
    void multiply_four(int first);

    static constexpr int rows = max_states + most,
                         states_stride = most + 4;  // 4: places the columns of one state in different cache sets

    const StateMatrix& P_;
    int used_, count_ = 0;
    std::array<double, most> innovation_, s_;
    std::array<detail::RowEntries, 4> four_;  // rows of the last scalars, until multiply_four()
    /// P H^T and below it (from row `used` on) the lower triangle of H P H^T; `solve` replaces them by G and L, with
    /// L L^T = H P H^T + R, G L^T = P H^T: the covariance is then P - G G^T. Column k of G is the gain of scalar k times sqrt(s).
    Eigen::Matrix<double, rows, most> G_;
    Eigen::Matrix<double, states_stride, max_states> by_state_;  // (P H^T)^T
};

/// Sets states first to first + 2 of P to the combinations rows . x of the other states; rows must not depend on them.
void clone(StateMatrix& P, const std::array<Row, 3>& rows, int first, int used);

/// The leading `used` states of P after a correction with an arbitrary gain k and an innovation of variance s; ph is P h.
void correct_covariance(StateMatrix& P, const StateVector& k, const StateVector& ph, double s, int used);

/// As `update` with a gain given by the caller, in Joseph form (I - k h) P (I - k h)^T + k r k^T: exact for any gain.
RowUpdate update_with_gain(StateVector& dx, StateMatrix& P, const Row& h, double innovation, double r, const StateVector& k,
                           int used);

/// Adjoint variables of the modified Bryson-Frazier smoother [Bierman1973]: the smoothed error at an instant is -P lambda with
/// covariance P - P Lambda P, where P is the filter's covariance. Equivalent to the Rauch-Tung-Striebel smoother without
/// inversion of a covariance, so states without uncertainty are permitted.
struct StateAdjoint {
    StateVector lambda;
    StateMatrix Lambda;

    explicit StateAdjoint(int size) : lambda(StateVector::Zero(size)), Lambda(StateMatrix::Zero(size, size)) {}
    /// Backward step over a scalar update.
    void undo(const RowUpdate& u, int used);
    /// Backward step over `clone`: later information about the clones becomes information about their source states.
    void undo_clone(const std::array<Row, 3>& rows, int first);
    /// Backward step over the reassignment of a state: earlier epochs are independent of its new meaning.
    void forget(int state);
};

}  // namespace schuler::estim
