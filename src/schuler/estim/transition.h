// Covariance propagation for states whose dynamics couple in the first nine rows: Phi = [A; 0 D] S, D diagonal, S a few shears.
//
// All error-state filters here have this structure: nine coupled states driven by the errors of the inertial sensors, and any number
// of processes, some of which are the integral of another (a clock bias, the gravity model). The cost depends on the number of non-zero
// (leading) columns of A; nothing is allocated and no N x N x N product is formed.
#pragma once

#include "schuler/estim/state.h"

#include <array>

namespace schuler::estim {

/// Phi for one time interval.
struct Transition {
    static constexpr int coupled = 9;
    static constexpr int max_driven = 52;  ///< columns of A

    /// x_to += factor x_from; neither is a coupled state.
    struct Shear {
        int to, from;
        double factor;
    };

    using Rows = Eigen::Matrix<double, max_driven, coupled>;

    int driven = padded(coupled);    ///< columns of A in use, a multiple of four; the others are zero
    Rows rows = Rows::Zero();        ///< column r holds row r of A
    StateVector diagonal;            ///< D; entries from 9 on are used
    std::array<Shear, 20> shears{};  ///< applied before A and D, in this order
    int shear_count = 0;

    /// Phi x.
    [[nodiscard]] StateVector times(const StateVector& x) const;
    /// Phi^T x.
    [[nodiscard]] StateVector transpose_times(const StateVector& x) const;
};

/// P <- Phi P Phi^T for the leading `used` states (a multiple of four, at least phi.driven): the exact product, P symmetric on entry
/// and on return. The remaining states are unchanged: they are not correlated with the others.
void propagate(StateMatrix& P, const Transition& phi, int used);

/// The leading 9 x 9 block of Phi P Phi^T alone. Shears are included if both their states are driven.
[[nodiscard]] Eigen::Matrix<double, Transition::coupled, Transition::coupled> propagated_corner(const StateMatrix& P,
                                                                                                const Transition& phi);

/// Row r such that r . Phi x = h . x for an error x at the start of the interval. For the states behind the coupled ones, the best
/// estimate of a Gauss-Markov process backward in time has the same factor as forward.
[[nodiscard]] StateVector row_after(const Transition& phi, const StateVector& h);

/// L <- Phi^T L Phi for symmetric L: the adjoint recursion of the smoother.
void propagate_adjoint(StateMatrix& L, const Transition& phi, int used);

}  // namespace schuler::estim
