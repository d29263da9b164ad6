// The estimators of paper A's chapter 2 against closed forms and against each other.
#include "schuler/estim/classical.h"
#include "schuler/core/error.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <random>

namespace schuler::estim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(Classical, LineThroughPointsByHand) {
    MatrixXd A(4, 2);
    A << 1, 0, 1, 1, 1, 2, 1, 3;
    const VectorXd y = (VectorXd(4) << 1.0, 3.0, 4.0, 4.0).finished();
    const Estimate e = least_squares(A, y);  // mean 3, slope 5/5 = 1: 1.5 + t; residuals -0.5, 0.5, 0.5, -0.5
    EXPECT_NEAR(e.x(0), 1.5, 1e-14);
    EXPECT_NEAR(e.x(1), 1.0, 1e-14);
    EXPECT_NEAR(e.P(1, 1), 0.5 / 5.0, 1e-14);  // s^2 / sum (t - mean)^2, s^2 = 1/2
    EXPECT_NEAR(e.P(0, 0), 0.5 * (0.25 + 2.25 / 5.0), 1e-14);
}

TEST(Classical, MaximumLikelihoodIsTheInformationForm) {
    std::mt19937_64 generator(4);
    std::normal_distribution<double> normal;
    const MatrixXd A = MatrixXd::NullaryExpr(9, 3, [&] { return normal(generator); });
    const VectorXd y = VectorXd::NullaryExpr(9, [&] { return normal(generator); });
    const MatrixXd root = MatrixXd::NullaryExpr(9, 9, [&] { return normal(generator); });
    const MatrixXd R = root * root.transpose() + MatrixXd::Identity(9, 9);
    const Estimate e = maximum_likelihood(A, y, R);
    const MatrixXd P = (A.transpose() * R.inverse() * A).inverse();
    EXPECT_LT((e.P - P).norm(), 1e-11);
    EXPECT_LT((e.x - P * A.transpose() * R.inverse() * y).norm(), 1e-11);
    // A prior is a measurement of everything.
    const Estimate prior{VectorXd::Ones(3), 0.3 * MatrixXd::Identity(3, 3)};
    const Estimate both = maximum_a_posteriori(A, y, R, prior);
    EXPECT_LT((both.P.inverse() - P.inverse() - prior.P.inverse()).norm(), 1e-9);
    EXPECT_LT((both.x - both.P * (P.inverse() * e.x + prior.P.inverse() * prior.x)).norm(), 1e-11);
}

// The worked comparison of docs/estimation.md: a constant bias measured a hundred times. The mean one by one, least squares and a
// Kalman filter without a prior and without walk are one and the same; so is the variance r/n.
TEST(Classical, FourWaysToAConstantAreOne) {
    std::mt19937_64 generator(20250707);
    std::normal_distribution<double> normal(0.7, 2.0);
    const int n = 100;
    VectorXd y(n);
    RecursiveMean mean;
    ScalarKalman kalman{0.0, 1e12, 0.0, 4.0};
    for (int i = 0; i < n; ++i) {
        y(i) = normal(generator);
        mean.add(y(i));
        const double gain = kalman.update(y(i));
        EXPECT_NEAR(gain, 1.0 / (i + 1), 1e-9);
    }
    const MatrixXd A = MatrixXd::Ones(n, 1);
    const Estimate batch = least_squares(A, y), likely = maximum_likelihood(A, y, 4.0 * MatrixXd::Identity(n, n));
    EXPECT_NEAR(mean.mean, batch.x(0), 1e-12);
    EXPECT_NEAR(likely.x(0), batch.x(0), 1e-12);
    EXPECT_NEAR(kalman.x, batch.x(0), 1e-9);
    EXPECT_NEAR(likely.P(0, 0), 4.0 / n, 1e-12);
    EXPECT_NEAR(kalman.P, 4.0 / n, 1e-9);
    EXPECT_NEAR(batch.P(0, 0) / (4.0 / n), 1.0, 0.4);
}

// A bias that walks: the mean falls behind, the filter settles at P = (q + sqrt(q^2 + 4 q r)) / 2 before an update.
TEST(Classical, WalkingBiasNeedsTheFilter) {
    std::mt19937_64 generator(11);
    std::normal_distribution<double> normal;
    const double q = 0.04, r = 4.0;
    double filter = 0.0, average = 0.0, predicted = 0.0;
    const int runs = 200, n = 400;
    for (int run = 0; run < runs; ++run) {
        double truth = 0.0;
        RecursiveMean mean;
        ScalarKalman kalman{0.0, 100.0, q, r};
        for (int i = 0; i < n; ++i) {
            truth += std::sqrt(q) * normal(generator);
            const double y = truth + std::sqrt(r) * normal(generator);
            kalman.predict(1.0);
            (void)kalman.update(y);
            mean.add(y);
        }
        filter += (kalman.x - truth) * (kalman.x - truth) / runs;
        average += (mean.mean - truth) * (mean.mean - truth) / runs;
        predicted = kalman.P;
    }
    const double prior = 0.5 * (q + std::sqrt(q * q + 4.0 * q * r));
    EXPECT_NEAR(predicted, prior * r / (prior + r), 1e-9);
    EXPECT_NEAR(filter / predicted, 1.0, 0.35);      // 200 runs: one sigma 0.1
    EXPECT_NEAR(average / (q * n / 3.0), 1.0, 0.4);  // the mean of a walk: q n / 3
}

TEST(Classical, WhatCannotBeEstimatedIsSaid) {
    const MatrixXd twice = MatrixXd::Ones(4, 2);
    EXPECT_THROW((void)least_squares(twice, VectorXd::Ones(4)), Error);
    EXPECT_THROW((void)maximum_likelihood(MatrixXd::Ones(2, 1), VectorXd::Ones(2), -MatrixXd::Identity(2, 2)), Error);
}

}  // namespace
}  // namespace schuler::estim
