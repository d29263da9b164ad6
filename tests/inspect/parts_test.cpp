// The pieces: rhythm of a channel, agreement of curves, the motion fit and the velocity lag against closed forms.
#include "schuler/inspect/detail/cadence.h"
#include "schuler/inspect/detail/motion/preintegration.h"
#include "schuler/inspect/detail/robust.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::inspect::detail {
namespace {

TEST(Cadence, CountsGapsDuplicatesAndStepsBackwards) {
    std::vector<double> t;
    for (int i = 0; i < 100; ++i) t.push_back(0.1 * i);
    t.push_back(9.9);    // duplicate
    t.push_back(10.7);   // gap of 0.8 s
    t.push_back(10.65);  // backwards
    t.push_back(10.75);
    t.push_back(10.95);  // one sample missing, no gap
    const Cadence c = cadence_of(t);
    EXPECT_NEAR(c.rate_hz, 10.0, 1e-9);
    ASSERT_EQ(c.gaps.size(), 1U);
    EXPECT_NEAR(c.gaps[0].start, 9.9, 1e-12);
    EXPECT_NEAR(c.gaps[0].length, 0.8, 1e-9);
    EXPECT_EQ(c.duplicates, 1U);
    EXPECT_EQ(c.backwards, 1U);
    EXPECT_EQ(c.missing, 7U + 1U);
    EXPECT_EQ(c.rows, 105U);
}

TEST(Cadence, AnExactTripleStepIsNoGap) {
    EXPECT_EQ(cadence_of(std::vector<double>{0.0, 0.1, 0.2, 0.5, 0.6, 0.7}).gaps.size(), 0U);
    EXPECT_EQ(cadence_of(std::vector<double>{0.0, 0.1, 0.2, 0.51, 0.6, 0.7}).gaps.size(), 1U);
}

TEST(Agreement, FindsTheVertexOfParabolasAndTheirDisagreement) {
    // Vertices 0.10 to 0.16, equal weights: the sum's vertex is their mean, and the jackknife deviation of a mean is
    // the standard error: sqrt(sum (x - mean)^2 / (n (n - 1))).
    std::vector<std::vector<double>> curves;
    for (const double vertex : {0.10, 0.12, 0.14, 0.16}) {
        std::vector<double> curve;
        for (int i = 0; i < 41; ++i) curve.push_back(1.0 + std::pow(-0.4 + 0.03 * i - vertex, 2));
        curves.push_back(curve);
    }
    const Agreement a = agree(-0.4, 0.03, curves);
    EXPECT_TRUE(a.found);
    EXPECT_NEAR(a.at, 0.13, 1e-12);
    EXPECT_NEAR(a.sigma, std::sqrt((2 * 0.03 * 0.03 + 2 * 0.01 * 0.01) / 12.0), 1e-12);
}

// Squares of a - cos: the residual of an oscillation of a period of 0.5 s, lowest at 0.5 s by its noise, or by its damping.
TEST(Agreement, OfAPeriodicMotionAPeriodAwayIsARivalUnlessTheDataTellThem) {
    for (const double damping : {0.01, 1.0}) {  // per second away from 0.5 s
        std::vector<std::vector<double>> curves;
        for (int window = 0; window < 6; ++window) {
            std::vector<double> curve;
            for (int i = 0; i < 91; ++i) {
                const double t = -0.48 + 0.02 * i;
                curve.push_back(30.0 + 20.0 * damping * std::abs(t - 0.5) - 20.0 * std::cos(4.0 * std::numbers::pi * t));
            }
            curves.push_back(curve);
        }
        const Agreement a = agree(-0.48, 0.02, curves);
        EXPECT_TRUE(a.found);
        EXPECT_NEAR(a.at, 0.5, 0.01);
        EXPECT_NEAR(a.nearest_to(0.05), damping < 0.1 ? 0.0 : 0.5, 0.01) << damping;
        EXPECT_NEAR(a.nearest_to(0.9), damping < 0.1 ? 1.0 : 0.5, 0.01) << damping;
    }
}

TEST(Agreement, OfScatteredCurvesHasARivalThatWithoutScatterIsNone) {
    for (const double scatter : {0.0, 4.0}) {
        std::vector<std::vector<double>> curves;
        for (const double side : {-1.0, 1.0, -1.0, 1.0, -1.0, 1.0})
            curves.push_back({30.0, 12.0 + side * scatter, 30.0, 30.0, 10.0, 30.0});
        EXPECT_EQ(agree(0.0, 0.1, curves).rivals.size(), scatter > 0.0 ? 1u : 0u) << scatter;
    }
}

TEST(Agreement, AMinimumAtTheEdgeIsNotFound) {
    const std::vector<double> falling{3.0, 2.0, 1.0};
    EXPECT_FALSE(agree(0.0, 0.1, {falling, falling, falling}).found);
}

TEST(Robust, QuantilesAndSigmaIgnoreWildValues) {
    std::vector<double> values;
    for (int i = -50; i <= 50; ++i) values.push_back(i);
    values.push_back(1e9);
    values.push_back(std::nan(""));
    EXPECT_NEAR(median(values), 1.0, 1.0);
    EXPECT_NEAR(robust_sigma(values), 1.4826 * 25.0, 2.0);
}

// Derivatives by the biases against differences of the integrals themselves.
TEST(Preintegration, BiasDerivativesMatchDifferences) {
    ImuSeries imu;
    for (int i = 0; i < 400; ++i) {
        const double t = 0.01 * i;
        imu.t.push_back(t);
        imu.w.emplace_back(0.3 * std::sin(t), 0.2, 0.5 * std::cos(0.7 * t));
        imu.f.emplace_back(1.0 + std::sin(2.0 * t), -0.5, -9.8);
    }
    imu.step = 0.01;
    const Eigen::Vector3d wb(0.01, -0.02, 0.005), fb(0.1, 0.2, -0.1);
    const Preintegral s = PreintegratedPath(imu, 0, 399, wb, fb).at(3.97);
    constexpr double h = 1e-5;
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector3d by_gyro =
            (PreintegratedPath(imu, 0, 399, wb + d, fb).at(3.97).u - PreintegratedPath(imu, 0, 399, wb - d, fb).at(3.97).u) /
            (2 * h);
        const Eigen::Vector3d by_accel =
            (PreintegratedPath(imu, 0, 399, wb, fb + d).at(3.97).u - PreintegratedPath(imu, 0, 399, wb, fb - d).at(3.97).u) /
            (2 * h);
        EXPECT_LT((by_gyro - s.u_by_gyro_bias.col(axis)).norm(), 1e-3 * s.u_by_gyro_bias.norm());
        EXPECT_LT((by_accel - s.u_by_accel_bias.col(axis)).norm(), 1e-4 * s.u_by_accel_bias.norm());
    }
}

}  // namespace
}  // namespace schuler::inspect::detail
