// A gathered propagation against dense products at every step, and the sparse update against the textbook's.
#include "schuler/estim/staged.h"

#include <gtest/gtest.h>

#include <random>

namespace schuler::estim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(Staged, EqualsThePropagationOfEveryStep) {
    constexpr int N = 12, M = 20;
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto random = [&](Eigen::Index r, Eigen::Index c) { return MatrixXd::NullaryExpr(r, c, [&] { return unit(generator); }).eval(); };
    const MatrixXd root = random(M, M);
    Eigen::Matrix<double, M, M> P = root * root.transpose();
    MatrixXd dense = P;
    GatheredTransition<N> gathered;
    MatrixXd Q = MatrixXd::Zero(N, N);
    Eigen::Matrix<double, M, 1> decay = Eigen::Matrix<double, M, 1>::Ones(), q = Eigen::Matrix<double, M, 1>::Zero();
    for (int step = 0; step < 7; ++step) {
        Transition<N> t;
        t.rows = random(N, 9);
        t.diagonal.tail<3>() = random(3, 1);
        gathered.then(t);
        MatrixXd phi = MatrixXd::Zero(M, M);
        phi.topLeftCorner(9, N) = t.rows.transpose();
        for (int i = 9; i < N; ++i) phi(i, i) = t.diagonal(i);
        for (int i = N; i < M; ++i) phi(i, i) = 0.9;
        MatrixXd noise = MatrixXd::Zero(M, M);
        for (int i = 0; i < N; ++i) noise(i, i) = 0.1 * (i + 1);
        dense = phi * dense * phi.transpose() + noise;
        Q = phi.topLeftCorner(N, N) * Q * phi.topLeftCorner(N, N).transpose() + noise.topLeftCorner(N, N);
        decay.tail<M - N>() *= 0.9;
    }
    const Eigen::Matrix<double, N, N> gathered_noise = Q;
    propagate_staged<M, N>(P, gathered, gathered_noise, decay, q);
    EXPECT_LT((P - dense).norm(), 1e-11 * dense.norm());
    EXPECT_LT((P - P.transpose()).norm(), 1e-12 * P.norm());
}

TEST(Staged, SparseUpdateIsTheOptimalOne) {
    constexpr int M = 16;
    std::mt19937_64 generator(6);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const MatrixXd root = MatrixXd::NullaryExpr(M, M, [&] { return unit(generator); });
    Eigen::Matrix<double, M, M> P = root * root.transpose();
    P = (0.5 * (P + P.transpose())).eval();
    Eigen::Matrix<double, M, 1> dx = Eigen::Matrix<double, M, 1>::NullaryExpr([&] { return unit(generator); });
    SparseRow<4> row;
    VectorXd h = VectorXd::Zero(M);
    for (const int i : {0, 3, 11, 15}) {
        h(i) = unit(generator);
        row.add(i, h(i));
    }
    const double r = 0.7, z = 2.5, s = h.dot(P * h) + r;
    const VectorXd k = P * h / s, expected = dx + k * (z - h.dot(dx));
    const MatrixXd I = MatrixXd::Identity(M, M);
    const MatrixXd joseph = (I - k * h.transpose()) * P * (I - k * h.transpose()).transpose() + r * k * k.transpose();
    const SparseUpdate u = update_sparse<M, 4>(dx, P, row, z, r);
    EXPECT_NEAR(u.s, s, 1e-12);
    EXPECT_LT((dx - expected).norm(), 1e-12);
    EXPECT_LT((P - joseph).norm(), 1e-12);
    EXPECT_EQ((P - P.transpose()).norm(), 0.0);
}

}  // namespace
}  // namespace schuler::estim
