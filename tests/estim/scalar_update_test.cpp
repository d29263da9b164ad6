// Sequential updates against the batch information form.
#include "random_systems.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <vector>

namespace schuler::estim {
namespace {

using namespace testing;

TEST(ScalarUpdate, SequenceEqualsTheBatchInInformationForm) {
    Numbers numbers(11);
    for (int trial = 0; trial < 20; ++trial) {
        Vector sigma(N);
        for (int i = 0; i < N; ++i) sigma(i) = std::pow(10.0, numbers.uniform(-2.0, 2.0));
        Matrix P = numbers.covariance(sigma);
        const LongMatrix prior = P.cast<long double>();
        LongMatrix information = inverse(prior);
        LongVector right = LongVector::Zero(N);
        Vector dx = Vector::Zero(N);
        for (int m = 0; m < 4; ++m) {
            const Vector h = numbers.vector().cwiseQuotient(sigma);
            const double r = std::pow(10.0, numbers.uniform(-3.0, 1.0)), innovation = 3.0 * numbers.normal();
            const RowUpdate u = update(dx, P, row_of(h), innovation, r, N);
            EXPECT_GT(u.s, r);
            EXPECT_EQ(P, P.transpose());
            const LongVector hl = h.cast<long double>();
            information += hl * hl.transpose() / static_cast<long double>(r);
            right += hl * static_cast<long double>(innovation / r);
        }
        const LongMatrix posterior = inverse(information);
        const LongVector error = posterior * right;
        for (int i = 0; i < N; ++i) {
            const long double si = std::sqrt(posterior(i, i));
            EXPECT_LT(std::abs(static_cast<long double>(dx(i)) - error(i)), 1e-10L * (si + std::abs(error(i)))) << i;
            for (int j = 0; j < N; ++j)
                EXPECT_LT(std::abs(static_cast<long double>(P(i, j)) - posterior(i, j)), 1e-9L * si * std::sqrt(posterior(j, j)));
        }
    }
}

TEST(ScalarUpdate, StaysPositiveOverTwelveOrdersOfMagnitude) {
    Numbers numbers(12);
    for (int trial = 0; trial < 10; ++trial) {
        Vector sigma(N);
        for (int i = 0; i < N; ++i) sigma(i) = std::pow(10.0, 3.0 - 6.0 * i / (N - 1));  // variances 1e6 to 1e-6
        Matrix P = numbers.covariance(sigma);
        double least = 1.0;
        for (int m = 0; m < 300; ++m) {
            Vector dx = Vector::Zero(N);
            Vector h = Vector::Zero(N);
            // Single states and mixtures, some measured far better than known.
            if (m % 3 == 0) h(m / 3 % N) = 1.0;
            else h = numbers.vector().cwiseQuotient(sigma);
            const double r = h.dot(P * h) * std::pow(10.0, numbers.uniform(-6.0, 2.0));
            ASSERT_GT(r, 0.0);
            const Vector before = P.diagonal();
            (void)update(dx, P, row_of(h), 1.0, r, N);
            ASSERT_EQ(P, P.transpose());
            ASSERT_TRUE((P.diagonal().array() >= 0.0).all());
            ASSERT_TRUE((P.diagonal().array() <= before.array() * (1.0 + 1e-12)).all());
            // Something is forgotten, so that there is something to learn.
            P.diagonal() += 1e-4 * sigma.cwiseAbs2();
            const Vector scale = P.diagonal().cwiseSqrt().cwiseInverse();
            const Matrix correlation = scale.asDiagonal() * P * scale.asDiagonal();
            least = std::min(
                least, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlation, Eigen::EigenvaluesOnly).eigenvalues()(0));
        }
        EXPECT_GT(least, 0.0);
    }
}

}  // namespace
}  // namespace schuler::estim
