// Statistics over runs, against cases whose answer is known.
#include "schuler/analysis/ensemble.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace schuler::analysis {
namespace {

TEST(Ensemble, QuantilesOfKnownValues) {
    std::vector<double> values;
    for (int i = 0; i <= 100; ++i) values.push_back(static_cast<double>((37 * i) % 101));  // 0 to 100 in disorder
    values.push_back(std::numeric_limits<double>::quiet_NaN());
    const Quantiles q = quantiles_of(values);
    EXPECT_DOUBLE_EQ(q.q05, 5.0);
    EXPECT_DOUBLE_EQ(q.median, 50.0);
    EXPECT_DOUBLE_EQ(q.q95, 95.0);
    EXPECT_NEAR(q.rms, std::sqrt(100.0 * 201.0 / 6.0), 1e-12);  // sum of squares n (n + 1) (2 n + 1) / 6 over 101
    EXPECT_TRUE(std::isnan(quantiles_of({}).median));
}

/// Runs of squared errors of three components, each a first-order process: independent runs, correlated epochs.
RunsByEpochs squared_errors(double scale, double kept, std::uint64_t seed) {
    constexpr int runs = 60, epochs = 400;
    RunsByEpochs values(runs, epochs);
    math::Random random(seed, "ensemble");
    for (int r = 0; r < runs; ++r) {
        Eigen::Vector3d x = random.normal3();
        for (int k = 0; k < epochs; ++k) {
            values(r, k) = scale * x.squaredNorm();
            x = kept * x + std::sqrt(1.0 - kept * kept) * random.normal3();
        }
    }
    return values;
}

TEST(Ensemble, BoundsHoldTheTruthAndNothingElse) {
    int inside = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const EnsembleConsistency c = ensemble_consistency(squared_errors(1.0, 0.95, seed), 3.0);
        inside += c.mean > c.low95 && c.mean < c.high95 ? 1 : 0;
        // A chi-square of a process with correlation 0.95 a step is worth 400 (1 - 0.95^2) / (1 + 0.95^2) independent steps.
        EXPECT_GT(c.worth, 0.5 * 20.5);
        EXPECT_LT(c.worth, 2.0 * 20.5);
        EXPECT_GT(c.inside, 0.80);
        const EnsembleConsistency wrong = ensemble_consistency(squared_errors(1.2, 0.95, seed), 3.0);
        EXPECT_TRUE(wrong.mean > wrong.high95) << seed;
    }
    EXPECT_GE(inside, 34);  // of 40, at 95 %: fewer once in 500
}

TEST(Ensemble, ConstantErrorsOfARunCountOnce) {
    const EnsembleConsistency c = ensemble_consistency(squared_errors(1.0, 1.0, 7), 3.0);
    EXPECT_LT(c.worth, 1.8);
    const Bounds b = mean_bounds(3.0, 60.0);
    EXPECT_LE(c.low95, b.low95 + 0.15);
    EXPECT_GE(c.high95, b.high95 - 0.15);
}

}  // namespace
}  // namespace schuler::analysis
