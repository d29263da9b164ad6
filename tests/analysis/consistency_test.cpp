#include "schuler/analysis/consistency.h"

#include "schuler/math/chi_square.h"
#include "support/draws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace schuler::analysis {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(Nees, IsTheQuadraticForm) {
    Matrix3d P;
    P << 4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0;
    const Vector3d e(1.0, -2.0, 0.7);
    EXPECT_NEAR(nees(e, P), e.dot(P.inverse() * e), 1e-13);
    EXPECT_TRUE(std::isnan(nees(e, -P)));
}

TEST(Nees, IndependentSamplesHaveTextbookBounds) {
    std::mt19937_64 rng(5);
    std::chi_squared_distribution<double> chi2(3.0);
    std::vector<double> values;
    for (int i = 0; i < 4000; ++i) values.push_back(chi2(rng));
    values.push_back(std::nan(""));
    const NeesStatistics s = nees_statistics(values, 3.0);
    EXPECT_EQ(s.expected, 3.0);
    EXPECT_NEAR(s.mean, 3.0, 0.15);
    EXPECT_GT(s.effective_samples, 3000.0);
    EXPECT_LE(s.effective_samples, 4000.0);
    EXPECT_NEAR(s.high95, math::chi_square_quantile(0.975, 3.0 * s.effective_samples) / s.effective_samples, 1e-12);
    EXPECT_LT(s.low95, 3.0);
    EXPECT_NEAR(s.high95 - s.low95, 2.0 * 1.96 * std::sqrt(6.0 / s.effective_samples), 0.002);
}

// Three first-order processes with neighbour correlation a: NEES has correlation a^(2k), so one of n samples in
// (1 + a^2)/(1 - a^2) is independent. Most runs' means must fall inside the bounds.
TEST(Nees, CorrelatedSamplesWidenTheBounds) {
    const double a = 0.98;
    std::mt19937_64 rng(6);
    std::normal_distribution<double> normal;
    int inside = 0;
    double effective = 0.0;
    const int runs = 200, n = 5000;
    for (int run = 0; run < runs; ++run) {
        Vector3d x = test::draw3(normal, rng);
        std::vector<double> values;
        for (int i = 0; i < n; ++i) {
            values.push_back(x.squaredNorm());
            const double b = std::sqrt(1.0 - a * a);
            x = a * x + b * test::draw3(normal, rng);
        }
        const NeesStatistics s = nees_statistics(values, 3.0);
        inside += s.mean > s.low95 && s.mean < s.high95;
        effective += s.effective_samples / runs;
    }
    EXPECT_NEAR(effective, n * (1.0 - a * a) / (1.0 + a * a), 0.25 * n * (1.0 - a * a));
    EXPECT_GT(inside, 0.87 * runs);
    EXPECT_LT(inside, runs);
}

TEST(Consistency, BlocksAreTheirOwnErrorsOverTheirOwnSigmas) {
    std::vector<ErrorRow> rows;
    // clang-format off
    for (int k = 0; k < 10; ++k) {
        rows.push_back({Time::from_seconds(k), {2.0, 0.0, 0.0}, {0.0, 0.3, 0.4}, {0.0, 0.0, 0.03}, {1.0, 9.0, 9.0},
                        {9.0, 0.1, 0.2}, {9.0, 9.0, 0.01}});
        // clang-format on
    }
    rows[0].position.x() = 1000.0;
    const ConsistencySummary c = consistency(rows, Time::from_seconds(1.0));
    EXPECT_NEAR(c.position.mean, 4.0, 1e-12);
    EXPECT_NEAR(c.velocity.mean, 9.0 + 4.0, 1e-12);
    EXPECT_NEAR(c.attitude.mean, 9.0, 1e-12);
    EXPECT_EQ(c.position.effective_samples, 1.0);  // a constant says it once
    EXPECT_TRUE(std::isnan(consistency({}, Time{}).position.mean));
}

/// How many of 200 runs of first-order errors lie outside their bounds, though their sigmas are `stated` times what they should be: 1.
/// One run is `length` correlation times long; `shared` is the correlation between the axes.
int runs_outside(double length, double shared, double stated, unsigned seed) {
    const int n = 400;
    const double a = std::exp(-length / n), b = std::sqrt(1.0 - a * a);
    Matrix3d R = Matrix3d::Constant(shared);
    R.diagonal().setOnes();
    const Matrix3d L = R.llt().matrixL();
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> normal;
    const Vector3d sigma = Vector3d::Constant(stated), none = not_given3();
    int outside = 0;
    for (int run = 0; run < 200; ++run) {
        Vector3d x = L * test::draw3(normal, rng);
        std::vector<ErrorRow> rows;
        for (int i = 0; i < n; ++i) {
            rows.push_back({Time::from_seconds(i), x, none, none, sigma, none, none});
            x = a * x + b * (L * test::draw3(normal, rng));
        }
        const NeesStatistics s = consistency(rows, Time{}).position;
        outside += s.mean < s.low95 || s.mean > s.high95;
    }
    return outside;
}

// Five in a hundred are meant: in long runs and in those of a few correlation times, with axes that share most of their error.
TEST(Consistency, OneMatchedRunInTwentyLiesOutside) {
    for (const double length : {5.0, 20.0, 100.0})
        for (const double shared : {0.0, 0.8}) {
            const int outside = runs_outside(length, shared, 1.0, 11);
            EXPECT_LE(outside, 20) << length << " correlation times, axes correlated by " << shared;
            EXPECT_GE(outside, 1) << length << " correlation times, axes correlated by " << shared;
        }
}

TEST(Consistency, SigmasThatAreTooSmallAreFound) {
    EXPECT_GT(runs_outside(100.0, 0.0, 0.7, 12), 180);
    EXPECT_GT(runs_outside(20.0, 0.0, 0.5, 13), 160);
}

TEST(Nis, MeanCountsAndNeighbourCorrelation) {
    std::mt19937_64 rng(8);
    std::normal_distribution<double> normal;
    const double a = 0.6;
    std::vector<InnovationSample> samples;
    Vector3d z = test::draw3(normal, rng);
    double sum = 0.0;
    for (int i = 0; i < 20000; ++i) {
        const double b = std::sqrt(1.0 - a * a);
        z = a * z + b * test::draw3(normal, rng);
        samples.push_back({z.head<2>().squaredNorm(), 2, true, {z.x(), z.y(), i % 2 == 0 ? 1e3 : -1e3}});  // third: unused
        sum += samples.back().nis;
        if (i % 100 == 0) samples.push_back({1e6, 2, false, {1e3, 1e3, 0.0}});
    }
    const NisStatistics s = nis_statistics(samples);
    EXPECT_EQ(s.accepted, 20000u);
    EXPECT_EQ(s.rejected, 200u);
    EXPECT_EQ(s.dof, 2.0);
    EXPECT_NEAR(s.mean, sum / 20000.0, 1e-10);
    EXPECT_NEAR(s.lag1, a, 0.03);
    EXPECT_TRUE(std::isnan(nis_statistics({}).mean));
}

}  // namespace
}  // namespace schuler::analysis
