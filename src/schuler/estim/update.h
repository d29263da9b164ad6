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
    static constexpr int most = 16;

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
};

/// What one scalar update did: enough to undo it in the backward pass of the smoother.
struct RowUpdate {
    Row h;
    StateVector k;              ///< gain
    double innovation = 0.0;    ///< less h . dx of the scalars before it in the same epoch
    double s = 1.0;             ///< innovation variance h P h^T + r
};

/// Updates the estimated error dx and the leading `used` states of P with `innovation` = h . error + noise of variance r (all in the
/// measurement's unit), with the optimal gain: P - P h h^T P / s, Joseph's form expanded for that gain, which keeps P exactly symmetric.
RowUpdate update(StateVector& dx, StateMatrix& P, const Row& h, double innovation, double r, int used);

/// Many such updates of one epoch: P is read throughout and written once, by a product of blocks. The same numbers but for rounding.
class EpochUpdate {
public:
    static constexpr int most = 64;   ///< scalars

    /// P is kept by reference and stays as it is until `apply`.
    EpochUpdate(const StateMatrix& P, int used);
    /// One more scalar, as `update` has it.
    RowUpdate add(StateVector& dx, const Row& h, double innovation, double r);
    /// As if no scalar had been added.
    void reset() { count_ = 0; }
    /// P after all of them; P is the matrix of the constructor.
    void apply(StateMatrix& P) const;

private:
    const StateMatrix& P_;
    int used_, count_ = 0;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_states, most> G_;   ///< P - G G^T is the covariance
    Eigen::Matrix<double, most, max_states> by_state_;                               ///< G^T: the gains of one state side by side
};

/// The same with a gain that somebody else chose, in Joseph's form (I - k h) P (I - k h)^T + k r k^T: exact for any gain.
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
    /// Steps backwards over the moment at which a state was given another meaning: what came before knows nothing of it.
    void forget(int state);
};

}  // namespace schuler::estim
