// Covariance propagation for states whose dynamics couple only in the first 9 rows: Phi = [A; 0 D], D diagonal.
//
// This is the shape of every error-state filter here: nine coupled states driven by any number of first-order processes.
// The cost is that of the non-zero columns of A; nothing is allocated and nothing of size N x N x N is multiplied.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace schuler::estim {

/// Rows 0..8 of Phi, stored by row (column r of `rows` is row r of A), and the diagonal D of the remaining states.
/// N is a multiple of 4, so that rows are whole vectors; unused states have zero covariance and cost little.
template <int N>
struct Transition {
    static constexpr int coupled = 9;
    static_assert(N % 4 == 0 && N >= 12);

    Eigen::Matrix<double, N, coupled> rows = Eigen::Matrix<double, N, coupled>::Zero();
    Eigen::Matrix<double, N, 1> diagonal = Eigen::Matrix<double, N, 1>::Ones();  ///< entries 9.. are used

    /// Phi x.
    [[nodiscard]] Eigen::Matrix<double, N, 1> times(const Eigen::Matrix<double, N, 1>& x) const {
        Eigen::Matrix<double, N, 1> y = diagonal.cwiseProduct(x);
        y.template head<coupled>().noalias() = rows.transpose() * x;
        return y;
    }

    /// Phi^T x.
    [[nodiscard]] Eigen::Matrix<double, N, 1> transpose_times(const Eigen::Matrix<double, N, 1>& x) const {
        Eigen::Matrix<double, N, 1> y = diagonal.cwiseProduct(x);
        y.template head<coupled>().setZero();
        y.noalias() += rows * x.template head<coupled>();
        return y;
    }
};

/// Which columns of A are not zero, for each of the three groups of three rows.
template <int N>
struct Sparsity {
    std::array<int, 3> count{};
    std::array<std::array<std::uint8_t, N>, 3> column{};

    void add(int group, int first, int number) {
        const auto g = static_cast<std::size_t>(group);
        for (int k = 0; k < number; ++k) column[g][static_cast<std::size_t>(count[g]++)] = static_cast<std::uint8_t>(first + k);
    }
};

/// P <- Phi P Phi^T + diag(q): the exact product, P symmetric on entry and on return.
template <int N>
void propagate(Eigen::Matrix<double, N, N>& P, const Transition<N>& phi, const Sparsity<N>& sparsity,
               const Eigen::Matrix<double, N, 1>& q);

/// L <- Phi^T L Phi for symmetric L: the adjoint recursion of the smoother.
template <int N>
void propagate_adjoint(Eigen::Matrix<double, N, N>& L, const Transition<N>& phi, const Sparsity<N>& sparsity);

extern template void propagate<16>(Eigen::Matrix<double, 16, 16>&, const Transition<16>&, const Sparsity<16>&,
                                   const Eigen::Matrix<double, 16, 1>&);
extern template void propagate<24>(Eigen::Matrix<double, 24, 24>&, const Transition<24>&, const Sparsity<24>&,
                                   const Eigen::Matrix<double, 24, 1>&);
extern template void propagate<44>(Eigen::Matrix<double, 44, 44>&, const Transition<44>&, const Sparsity<44>&,
                                   const Eigen::Matrix<double, 44, 1>&);
extern template void propagate_adjoint<16>(Eigen::Matrix<double, 16, 16>&, const Transition<16>&, const Sparsity<16>&);
extern template void propagate_adjoint<24>(Eigen::Matrix<double, 24, 24>&, const Transition<24>&, const Sparsity<24>&);
extern template void propagate_adjoint<44>(Eigen::Matrix<double, 44, 44>&, const Transition<44>&, const Sparsity<44>&);

}  // namespace schuler::estim
