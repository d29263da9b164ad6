// Runs of refused fixes: what their innovations tell, and which level of a receiver counts.
#include "schuler/filter/integrity/refused_fixes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace schuler::filter {
namespace {

using Eigen::Vector3d;

constexpr double sigma = 0.5;  // m, of one fix

/// The shape of a run of fixes at a rate whose innovations are of a function of time, with noise.
template <class Innovation>
RunShape shape_of(Innovation innovation, double seconds, double rate, unsigned seed = 1) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise(0.0, sigma);
    RefusedRun run;
    for (int k = 0; k <= static_cast<int>(seconds * rate); ++k) {
        const double t = k / rate;
        const Vector3d n(noise(generator), noise(generator), noise(generator));
        run.add(Time::from_seconds(100.0 + t), Vector3d(innovation(t) + n), sigma);
    }
    return run.shape(0.02);
}

/// Rates of 1 to 20 Hz and spans beyond what is kept; every seed.
template <class Innovation>
void expect_shape(RunShape expected, Innovation innovation) {
    for (const double rate : {1.0, 4.0, 20.0})
        for (const double seconds : {6.0, 12.0, 40.0})
            for (unsigned seed = 0; seed < 20; ++seed)
                ASSERT_EQ(shape_of(innovation, seconds, rate, seed), expected)
                    << rate << " Hz, " << seconds << " s, seed " << seed;
}

TEST(RefusedRun, TellsAJumpFromWhatIsDraggedAwayAndWhatRunsAway) {
    expect_shape(RunShape::Constant, [](double) { return Vector3d(12.0, -9.0, 1.0); });
    expect_shape(RunShape::Uniform, [](double t) { return Vector3d(6.0 + 4.0 * t, -3.0 * t, 0.0); });
    expect_shape(RunShape::Growing, [](double t) { return Vector3d(6.0 + 1.5 * t * t, -2.0 * t * t, 0.0); });  // a tilt
    expect_shape(RunShape::Erratic, [](double t) { return Vector3d(80.0 * std::sin(3.0 * t), 90.0 * std::cos(2.3 * t), 0.0); });
}

TEST(RefusedRun, SaysNothingBeforeThereIsEnough) {
    RefusedRun run;
    EXPECT_EQ(run.shape(0.0), RunShape::Short);
    for (int k = 0; k < 3; ++k) run.add(Time::from_seconds(k), Vector3d(10.0, 0.0, 0.0), sigma);
    EXPECT_EQ(run.shape(0.0), RunShape::Short);
    run.add(Time::from_seconds(3.0), Vector3d(10.0, 0.0, 0.0), sigma);
    EXPECT_EQ(run.shape(0.0), RunShape::Constant);
    RefusedRun quick;  // many, in half a second
    for (int k = 0; k < 20; ++k) quick.add(Time::from_seconds(0.025 * k), Vector3d(10.0, 0.0, 0.0), sigma);
    EXPECT_EQ(quick.shape(0.0), RunShape::Short);
}

/// Whatever number of fixes: first and last are kept, mean and rate are those of all within a few percent.
TEST(RefusedRun, ThinsOutEvenly) {
    RefusedRun run;
    for (int k = 0; k < 1000; ++k) {
        run.add(Time::from_seconds(0.1 * k), Vector3d(5.0 + 0.02 * k, 1.0, -2.0), sigma);
        EXPECT_EQ(run.count(), k + 1);
        EXPECT_NEAR(run.span(), 0.1 * k, 1e-9);
        EXPECT_DOUBLE_EQ(run.latest().x(), 5.0 + 0.02 * k);
    }
    EXPECT_NEAR(run.rate().x(), 0.2, 1e-9);
    EXPECT_NEAR(run.mean().x(), 5.0 + 0.02 * 499.5, 0.05 * 0.02 * 1000);
}

TEST(FixLevels, AJumpThatComesBackIsForgotten) {
    FixLevels levels;
    for (int k = 0; k < 100; ++k) levels.confirm(false, 1.0);
    levels.jumped({100.0, 0.0, 0.0}, 0.0, 3.0, true);
    EXPECT_GE(3.0 * levels.spread().x(), 100.0);  // both are covered
    for (int k = 0; k < 20; ++k) levels.confirm(true, 1.0);
    EXPECT_FALSE(levels.prefers_other());
    EXPECT_GE(3.0 * levels.spread().x(), 100.0);
    levels.confirm(false, 1.0);
    EXPECT_FALSE(levels.two);
    EXPECT_EQ(levels.spread(), Vector3d(0.0, 0.0, 0.0));
}

TEST(FixLevels, TheLevelThatWasHeldForLongerCountsAndTheDoubtFades) {
    FixLevels levels;
    for (int k = 0; k < 50; ++k) levels.confirm(false, 1.0);
    levels.jumped({0.0, 30.0, 0.0}, 0.0, 3.0, true);
    int seconds = 0;
    while (!levels.prefers_other()) levels.confirm(true, 1.0), ++seconds;
    EXPECT_NEAR(seconds, 48, 1);
    levels.swap();
    EXPECT_EQ(levels.other.y(), -30.0);
    double before = std::abs(levels.spread().y());
    EXPECT_GE(3.0 * before, 30.0);
    for (int k = 0; levels.two && k < 100'000; ++k) {
        levels.confirm(false, 1.0);
        EXPECT_LE(std::abs(levels.spread().y()), before);
        before = std::abs(levels.spread().y());
    }
    EXPECT_FALSE(levels.two);
    // After an interruption what was held before it counts for half a minute at most.
    FixLevels interrupted;
    for (int k = 0; k < 500; ++k) interrupted.confirm(false, 1.0);
    interrupted.jumped({0.0, 30.0, 0.0}, 0.0, 3.0, false);
    for (int k = 0; k < 28; ++k) interrupted.confirm(true, 1.0);
    EXPECT_TRUE(interrupted.prefers_other());
}

TEST(FixLevels, WhatWasHeldBeforeAnInterruptionCountsForTheLevelThatItForetold) {
    const auto jumped = [](const Vector3d& innovation, double sigma) {
        FixLevels levels;
        for (int k = 0; k < 200; ++k) levels.confirm(false, 1.0);
        levels.interrupted(innovation, Vector3d::Constant(sigma));
        for (int k = 0; k < 4; ++k) levels.confirm(false, 1.0);
        levels.jumped({20.0, 0.0, 0.0}, 1.0, 2.0, true);  // the other level: 20 m behind
        return levels;
    };
    // the estimate did not know: only what was held since
    EXPECT_DOUBLE_EQ(jumped({-9.0, 0.0, 0.0}, 8.0).here, 4.0);
    EXPECT_DOUBLE_EQ(jumped({-9.0, 0.0, 0.0}, 8.0).there, 2.0);
    // the first fix was where it was expected
    EXPECT_DOUBLE_EQ(jumped({-0.5, 0.0, 0.0}, 3.0).here, 204.0);
    // it would have been so at the other level
    EXPECT_DOUBLE_EQ(jumped({-19.0, 0.0, 0.0}, 5.0).here, 4.0);
    EXPECT_DOUBLE_EQ(jumped({-19.0, 0.0, 0.0}, 5.0).there, 202.0);
}

TEST(FixLevels, FixesOfTheOtherLevelDoNotTellMoreThanWasKnownAtTheJump) {
    constexpr double known = 6.0;
    FixLevels levels;
    levels.jumped({20.0, 0.0, 0.0}, known, 2.0, true);
    double information = 0.0;
    for (int k = 0; k < 10'000; ++k) {
        information += 1.0 / levels.shared_variance();
        levels.confirm(true, 0.2);
    }
    EXPECT_LT(information, 2.0 / (known * known));
    EXPECT_GT(information, 0.5 / (known * known));
}

}  // namespace
}  // namespace schuler::filter
