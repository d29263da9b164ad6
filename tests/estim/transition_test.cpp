// Structured covariance propagation against the dense products, in extended precision.
#include "schuler/estim/transition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace schuler::estim {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

template <int N>
struct Case {
    Transition<N> phi;
    Sparsity<N> sparsity;
    Eigen::Matrix<double, N, N> P;
    Eigen::Matrix<double, N, 1> q;

    explicit Case(std::mt19937_64& generator) {
        std::normal_distribution<double> normal;
        std::uniform_int_distribution<int> count(1, N);
        for (int group = 0; group < 3; ++group) {
            std::vector<int> columns(N);
            std::iota(columns.begin(), columns.end(), 0);
            std::shuffle(columns.begin(), columns.end(), generator);
            columns.resize(static_cast<std::size_t>(count(generator)));
            for (const int column : columns) {
                sparsity.add(group, column, 1);
                for (int r = 0; r < 3; ++r) phi.rows(column, 3 * group + r) = normal(generator);
            }
        }
        // The first nine are not part of Phi: whatever stands there must not matter.
        for (int i = 0; i < N; ++i) phi.diagonal(i) = i < 9 ? 1e30 : normal(generator);
        Eigen::Matrix<double, N, N> root;
        for (int i = 0; i < N * N; ++i) root(i) = normal(generator);
        const Eigen::Matrix<double, N, N> square = root * root.transpose();
        P = 0.5 * (square + square.transpose());
        for (int i = 0; i < N; ++i) q(i) = std::abs(normal(generator));
    }

    [[nodiscard]] LongMatrix dense() const {
        LongMatrix D = LongMatrix::Zero(N, N);
        D.topRows(9) = phi.rows.transpose().template cast<long double>();
        for (int i = 9; i < N; ++i) D(i, i) = static_cast<long double>(phi.diagonal(i));
        return D;
    }
};

/// Every entry within 1e-13 of the sum of the sizes that went into it.
template <class Actual>
void expect_equal(const Actual& actual, const LongMatrix& expected, const LongMatrix& size) {
    for (Eigen::Index i = 0; i < expected.rows(); ++i)
        for (Eigen::Index j = 0; j < expected.cols(); ++j)
            ASSERT_LE(std::abs(static_cast<long double>(actual(i, j)) - expected(i, j)), 1e-13L * size(i, j))
                << "entry (" << i << ", " << j << ")";
}

template <int N>
void check_size() {
    std::mt19937_64 generator(20240700 + N);
    for (int trial = 0; trial < 20; ++trial) {
        SCOPED_TRACE("N = " + std::to_string(N) + ", trial " + std::to_string(trial));
        const Case<N> c(generator);
        const LongMatrix phi = c.dense(), P = c.P.template cast<long double>();
        const LongMatrix q = c.q.template cast<long double>().asDiagonal();

        Eigen::Matrix<double, N, N> forward = c.P;
        propagate<N>(forward, c.phi, c.sparsity, c.q);
        expect_equal(forward, phi * P * phi.transpose() + q, phi.cwiseAbs() * P.cwiseAbs() * phi.cwiseAbs().transpose() + q);
        EXPECT_EQ(forward, forward.transpose());

        Eigen::Matrix<double, N, N> backward = c.P;
        propagate_adjoint<N>(backward, c.phi, c.sparsity);
        expect_equal(backward, phi.transpose() * P * phi, phi.cwiseAbs().transpose() * P.cwiseAbs() * phi.cwiseAbs());
        EXPECT_EQ(backward, backward.transpose());

        const Eigen::Matrix<double, N, 1> x = c.P.col(trial % N);
        const LongMatrix xl = x.template cast<long double>();
        expect_equal(c.phi.times(x), phi * xl, phi.cwiseAbs() * xl.cwiseAbs());
        expect_equal(c.phi.transpose_times(x), phi.transpose() * xl, phi.cwiseAbs().transpose() * xl.cwiseAbs());
    }
}

TEST(Transition, PropagatesAsTheDenseProducts16) { check_size<16>(); }
TEST(Transition, PropagatesAsTheDenseProducts24) { check_size<24>(); }
TEST(Transition, PropagatesAsTheDenseProducts44) { check_size<44>(); }

TEST(Transition, StaysPositiveOverManySteps) {
    // A rotation of the coupled states and slow decay of the others: nothing grows but by q.
    Transition<16> phi;
    Sparsity<16> sparsity;
    for (int group = 0; group < 3; ++group) sparsity.add(group, 3 * group, 3);
    for (int group = 0; group < 3; ++group) {
        const double c = std::cos(0.1 * (group + 1)), s = std::sin(0.1 * (group + 1));
        const int o = 3 * group;
        phi.rows(o, o) = c, phi.rows(o + 1, o) = -s;
        phi.rows(o, o + 1) = s, phi.rows(o + 1, o + 1) = c;
        phi.rows(o + 2, o + 2) = 1.0;
    }
    phi.diagonal.tail<7>().setConstant(0.999);
    Eigen::Matrix<double, 16, 16> P = Eigen::Matrix<double, 16, 16>::Identity();
    const Eigen::Matrix<double, 16, 1> q = Eigen::Matrix<double, 16, 1>::Constant(1e-4);
    const int steps = 10000;
    for (int k = 0; k < steps; ++k) propagate<16>(P, phi, sparsity, q);
    // Rotations keep the identity: 1 + n q; a Gauss-Markov state tends to q / (1 - d^2).
    const double decayed = std::pow(0.999, 2.0 * steps), limit = 1e-4 / (1.0 - 0.999 * 0.999);
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(P(i, i), 1.0 + steps * 1e-4, 1e-10);
    for (int i = 9; i < 16; ++i) EXPECT_NEAR(P(i, i), decayed + (1.0 - decayed) * limit, 1e-12);
    EXPECT_LT((P - Eigen::Matrix<double, 16, 16>(P.diagonal().asDiagonal())).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace schuler::estim
