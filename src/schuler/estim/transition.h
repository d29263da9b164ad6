// Covariance propagation for states whose dynamics couple in the first nine rows: Phi = [A; 0 D] S, D diagonal, S a few shears.
//
// This is the shape of every error-state filter here: nine coupled states driven by the errors of the inertial sensors, and any number
// of processes, of which some are the integral of another (a clock's bias, the chain of gravity). The cost is that of the columns of A that are
// not zero, the leading ones; nothing is allocated and nothing of size N x N x N is multiplied.
#pragma once

#include "schuler/estim/state.h"

#include <array>

namespace schuler::estim {

/// Phi of one span of time.
struct Transition {
    static constexpr int coupled = 9;
    static constexpr int max_driven = 48;  ///< columns of A

    /// x_to += factor x_from, both behind the coupled states.
    struct Shear {
        int to, from;
        double factor;
    };

    using Rows = Eigen::Matrix<double, max_driven, coupled>;

    int driven = padded(coupled);    ///< columns of A in use, a multiple of four; further ones are zero
    Rows rows = Rows::Zero();        ///< column r is row r of A
    StateVector diagonal;            ///< D; entries from 9 on are used
    std::array<Shear, 20> shears{};  ///< before A and D, in this order
    int shear_count = 0;

    /// Phi x.
    [[nodiscard]] StateVector times(const StateVector& x) const;
    /// Phi^T x.
    [[nodiscard]] StateVector transpose_times(const StateVector& x) const;
};

/// P <- Phi P Phi^T for the leading `used` states (a multiple of four, at least phi.driven): the exact product, P symmetric on entry and
/// on return. The others stay as they are: they are not correlated with the rest.
void propagate(StateMatrix& P, const Transition& phi, int used);

/// The leading 9 x 9 block of Phi P Phi^T alone. Shears count where both their states are driven.
[[nodiscard]] Eigen::Matrix<double, Transition::coupled, Transition::coupled> propagated_corner(const StateMatrix& P,
                                                                                                const Transition& phi);

/// r such that r . Phi x = h . x for an error x at the start of the span. Behind the coupled states, of which a process that forgets says
/// of its past no more than of its future, best guess and factor are the same in both directions.
[[nodiscard]] StateVector row_after(const Transition& phi, const StateVector& h);

/// L <- Phi^T L Phi for symmetric L: the adjoint recursion of the smoother.
void propagate_adjoint(StateMatrix& L, const Transition& phi, int used);

}  // namespace schuler::estim
