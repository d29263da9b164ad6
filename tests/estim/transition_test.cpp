// Structured covariance propagation and updates at run-time size against the dense products, in extended precision.
#include "schuler/estim/transition.h"
#include "schuler/estim/update.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace schuler::estim {
namespace {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// A random filter: n states of which `used` are in use, the first `driven` driving the coupled nine.
struct Case {
    Transition phi;
    StateMatrix P;
    int used;

    Case(std::mt19937_64& generator, int n, int used_, int driven) : used(used_) {
        std::normal_distribution<double> normal;
        phi.driven = padded(driven);
        for (int r = 0; r < 9; ++r)
            for (int c = 0; c < driven; ++c) phi.rows(c, r) = normal(generator);
        // The first nine are not part of Phi: whatever stands there must not matter.
        phi.diagonal = StateVector(n);
        for (int i = 0; i < n; ++i) phi.diagonal(i) = i < 9 ? 1e30 : normal(generator);
        if (used >= driven + 2) {
            phi.shears[0] = {used - 2, used - 1, normal(generator)};
            phi.shear_count = 1;
        }
        Eigen::MatrixXd root(used, used);
        for (int i = 0; i < used * used; ++i) root(i) = normal(generator);
        P = StateMatrix::Zero(n, n);
        P.topLeftCorner(used, used) = root * root.transpose();
        P = (0.5 * (P + P.transpose())).eval();
    }
    [[nodiscard]] LongMatrix dense() const {
        const Eigen::Index n = P.rows();
        LongMatrix D = LongMatrix::Zero(n, n), S = LongMatrix::Identity(n, n);
        for (int r = 0; r < 9; ++r)
            for (int c = 0; c < phi.driven; ++c) D(r, c) = static_cast<long double>(phi.rows(c, r));
        for (int i = 9; i < n; ++i) D(i, i) = static_cast<long double>(phi.diagonal(i));
        for (int i = 0; i < phi.shear_count; ++i) {
            const Transition::Shear& s = phi.shears[static_cast<std::size_t>(i)];
            S(s.to, s.from) += static_cast<long double>(s.factor);
        }
        return D * S;
    }
};

/// Every entry within 1e-13 of the sum of the sizes that went into it.
template <class Actual>
void expect_equal(const Actual& actual, const LongMatrix& expected, const LongMatrix& size) {
    for (Eigen::Index i = 0; i < expected.rows(); ++i)
        for (Eigen::Index j = 0; j < expected.cols(); ++j)
            ASSERT_LE(std::abs(static_cast<long double>(actual(i, j)) - expected(i, j)), 2e-13L * size(i, j))
                << "entry (" << i << ", " << j << ")";
}

TEST(Transition, PropagatesAsTheDenseProducts) {
    std::mt19937_64 generator(20240700);
    for (const auto& [n, used, driven] :
         {std::array{16, 16, 15}, std::array{24, 24, 21}, std::array{52, 32, 15}, std::array{max_states, max_states, 33}}) {
        for (int trial = 0; trial < 10; ++trial) {
            SCOPED_TRACE("n = " + std::to_string(n) + ", trial " + std::to_string(trial));
            const Case c(generator, n, used, driven);
            const LongMatrix phi = c.dense(), P = c.P.cast<long double>();

            StateMatrix forward = c.P;
            propagate(forward, c.phi, c.used);
            expect_equal(forward, phi * P * phi.transpose(), phi.cwiseAbs() * P.cwiseAbs() * phi.cwiseAbs().transpose());
            EXPECT_EQ(forward, forward.transpose());

            StateMatrix backward = c.P;
            propagate_adjoint(backward, c.phi, c.used);
            const LongMatrix size = phi.cwiseAbs().transpose() * P.cwiseAbs() * phi.cwiseAbs();
            expect_equal(backward, phi.transpose() * P * phi, size);
            EXPECT_EQ(backward, backward.transpose());

            const StateVector x = c.P.col(trial % used);
            const LongMatrix xl = x.cast<long double>();
            expect_equal(c.phi.times(x), phi * xl, phi.cwiseAbs() * xl.cwiseAbs());
            expect_equal(c.phi.transpose_times(x), phi.transpose() * xl, phi.cwiseAbs().transpose() * xl.cwiseAbs());
        }
    }
}

TEST(Transition, StaysPositiveOverManySteps) {
    // A rotation of the coupled states and slow decay of the others: nothing grows.
    Transition phi;
    phi.driven = 12;
    for (int group = 0; group < 3; ++group) {
        const double c = std::cos(0.1 * (group + 1)), s = std::sin(0.1 * (group + 1));
        const int o = 3 * group;
        phi.rows(o, o) = c, phi.rows(o + 1, o) = -s;
        phi.rows(o, o + 1) = s, phi.rows(o + 1, o + 1) = c;
        phi.rows(o + 2, o + 2) = 1.0;
    }
    phi.diagonal = StateVector::Constant(16, 0.999);
    StateMatrix P = StateMatrix::Identity(16, 16);
    const double q = 1e-4;
    const int steps = 10000;
    for (int k = 0; k < steps; ++k) {
        propagate(P, phi, 16);
        P.diagonal().array() += q;
    }
    // Rotations keep the identity: 1 + n q; a Gauss-Markov state tends to q / (1 - d^2).
    const double decayed = std::pow(0.999, 2.0 * steps), limit = q / (1.0 - 0.999 * 0.999);
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(P(i, i), 1.0 + steps * q, 1e-10);
    for (int i = 9; i < 16; ++i) EXPECT_NEAR(P(i, i), decayed + (1.0 - decayed) * limit, 1e-12);
    EXPECT_LT((P - StateMatrix(P.diagonal().asDiagonal())).cwiseAbs().maxCoeff(), 1e-12);
}

/// A row with dense and named entries, one of them twice.
Row some_row(std::mt19937_64& generator) {
    std::normal_distribution<double> normal;
    Row row;
    for (int i = 0; i < 9; ++i) row.head(i) = i == 4 ? 0.0 : normal(generator);
    for (const int i : {11, 20, 11}) row.add(i, normal(generator));
    return row;
}

TEST(Update, IsTheTextbooks) {
    std::mt19937_64 generator(6);
    std::normal_distribution<double> normal;
    for (const bool optimal : {true, false}) {
        const Case c(generator, 28, 24, 15);
        const Row row = some_row(generator);
        Eigen::VectorXd h(28);
        for (int i = 0; i < 28; ++i) h(i) = row(i);
        EXPECT_GT(h.tail(19).norm(), 0.0);
        StateVector dx = StateVector::Zero(28);
        for (int i = 0; i < 24; ++i) dx(i) = normal(generator);
        const double r = 0.7, z = 2.5, s = h.dot(c.P * h) + r;
        Eigen::VectorXd k = c.P * h / s;
        if (!optimal) k.head(24) *= 0.6;
        const Eigen::VectorXd expected = dx + k * (z - h.dot(dx));
        const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(28, 28);
        const Eigen::MatrixXd joseph =
            (I - k * h.transpose()) * c.P * (I - k * h.transpose()).transpose() + r * k * k.transpose();
        StateMatrix P = c.P;
        const StateVector gain = k;
        const RowUpdate u = optimal ? update(dx, P, row, z, r, 24) : update_with_gain(dx, P, row, z, r, gain, 24);
        EXPECT_NEAR(u.s, s, 1e-11 * s);
        EXPECT_LT((u.k - k).norm(), 1e-12 * k.norm());
        EXPECT_LT((dx - expected).norm(), 1e-12 * expected.norm());
        EXPECT_LT((P - joseph).norm(), 1e-12 * c.P.norm());
        EXPECT_EQ((P - P.transpose()).norm(), 0.0);
    }
}

TEST(Update, OfAWholeEpochIsThatOfItsScalars) {
    std::mt19937_64 generator(7);
    std::normal_distribution<double> normal;
    for (const auto& [used, scalars] : {std::pair{28, 1}, {28, 7}, {28, 48}, {48, 24}, {60, 30}, {100, 12}}) {
        const Case c(generator, used + 4, used, 15);
        StateMatrix one_by_one = c.P, at_once = c.P;
        StateVector dx = StateVector::Zero(used + 4), dx_at_once = dx;
        EpochUpdate epoch(at_once, used);
        epoch.add(some_row(generator), 5.0, 1.0);  // taken back
        epoch.reset();
        std::vector<RowUpdate> expected;
        for (int i = 0; i < scalars; ++i) {
            const Row row = some_row(generator);
            const double z = normal(generator);
            expected.push_back(update(dx, one_by_one, row, z, 0.5, used));
            epoch.add(row, z, 0.5);
        }
        dx_at_once = epoch.solve();
        for (int i = 0; i < scalars; ++i) {
            const RowUpdate &a = expected[static_cast<std::size_t>(i)], b = epoch.result(a.h, i);
            EXPECT_NEAR(a.s, b.s, 1e-10 * a.s);
            EXPECT_NEAR(a.innovation, b.innovation, 1e-9);
            EXPECT_LT((a.k - b.k).norm(), 1e-9 * (1e-3 + a.k.norm()));
        }
        EXPECT_EQ((at_once - c.P).norm(), 0.0);
        epoch.apply(at_once);
        EXPECT_LT((at_once - one_by_one).norm(), 1e-11 * c.P.norm());
        EXPECT_EQ((at_once - at_once.transpose()).norm(), 0.0);
        EXPECT_LT((dx - dx_at_once).norm(), 1e-9 * dx.norm());
    }
}

/// The smoother's recursion against dense products.
TEST(Update, AdjointStepsBack) {
    std::mt19937_64 generator(8);
    const Case c(generator, 24, 24, 15), prior(generator, 24, 24, 15);
    StateVector dx = StateVector::Zero(24);
    StateMatrix P = c.P;
    const RowUpdate u = update(dx, P, some_row(generator), 1.3, 0.5, 24);
    StateAdjoint a(24);
    a.lambda = prior.P.col(0);
    a.Lambda = prior.P;
    Eigen::VectorXd h(24);
    for (int i = 0; i < 24; ++i) h(i) = u.h(i);
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(24, 24) - u.k * h.transpose();
    const Eigen::VectorXd lambda = A.transpose() * a.lambda - h * (u.innovation / u.s);
    const Eigen::MatrixXd Lambda = A.transpose() * a.Lambda * A + h * h.transpose() / u.s;
    a.undo(u, 24);
    EXPECT_LT((a.lambda - lambda).norm(), 1e-12 * lambda.norm());
    EXPECT_LT((a.Lambda - Lambda).norm(), 1e-12 * Lambda.norm());
    a.forget(11);
    EXPECT_EQ(a.lambda(11), 0.0);
    EXPECT_EQ(a.Lambda.row(11).norm() + a.Lambda.col(11).norm(), 0.0);
    EXPECT_GT(a.Lambda.norm(), 0.0);
}

}  // namespace
}  // namespace schuler::estim
