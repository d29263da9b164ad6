// The gate with recovery: outliers stay out, and an estimate that is off for good is found out.
#include "schuler/filter/integrity/gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace schuler::filter {
namespace {

using Eigen::Vector3d;

constexpr double white = 1.0;  // m, of the measurements here

GateLimits limits() {
    GateLimits l;
    l.chi_square[1] = 15.1, l.chi_square[2] = 18.4, l.chi_square[3] = 21.1;
    return l;
}

GateDecision meet(GateState& state, double t, const Vector3d& innovation, double drift_sigma = 0.1) {
    return decide(state, limits(), Time::from_seconds(t), 3, innovation.squaredNorm() / (white * white), innovation,
                  Vector3d::Constant(white), drift_sigma);
}

/// Time of the first decision that is not a rejection; negative where there is none.
template <class Innovation>
double first_recovery(double from, double spacing, int count, Innovation innovation, double drift_sigma = 0.1) {
    GateState state;
    for (int k = 0; k < count; ++k) {
        const double t = from + spacing * k;
        const GateDecision d = meet(state, t, innovation(t), drift_sigma);
        if (d == GateDecision::Reject) continue;
        EXPECT_EQ(d, GateDecision::Recover);
        return t;
    }
    return -1.0;
}

TEST(Gate, LimitIsThatOfTheDegreesOfFreedom) {
    for (int dof = 1; dof <= 3; ++dof) {
        const double limit = limits().chi_square[dof];
        GateState state;
        EXPECT_EQ(decide(state, limits(), {}, dof, limit, Vector3d::Ones(), Vector3d::Ones(), 0.1), GateDecision::Accept);
        EXPECT_EQ(decide(state, limits(), {}, dof, 1.001 * limit, Vector3d::Ones(), Vector3d::Ones(), 0.1), GateDecision::Reject);
    }
}

TEST(Gate, SingleOutlierIsRejectedAndTheNextFixAccepted) {
    GateState state;
    for (int k = 0; k < 200; ++k) {
        const bool outlier = k % 20 == 7;
        const Vector3d innovation = outlier ? Vector3d(30.0, 0.0, 0.0) : Vector3d(0.5, -0.5, 0.2);
        EXPECT_EQ(meet(state, k, innovation), outlier ? GateDecision::Reject : GateDecision::Accept) << k;
        EXPECT_EQ(state.run, outlier ? 1 : 0);
    }
}

TEST(Gate, ConsistentRunWinsAfterTheTimeAndTheCount) {
    std::mt19937_64 generator(5);
    std::normal_distribution<double> noise;
    const auto shifted = [&](double) {
        return Vector3d(50.0 + white * noise(generator), white * noise(generator), white * noise(generator));
    };
    EXPECT_DOUBLE_EQ(first_recovery(100.0, 1.0, 100, shifted), 110.0);  // the time decides
    EXPECT_DOUBLE_EQ(first_recovery(100.0, 0.125, 800, shifted), 110.0);
    EXPECT_DOUBLE_EQ(first_recovery(100.0, 5.0, 100, shifted), 145.0);  // the count decides: the tenth
    // After a recovery the memory is empty.
    GateState state;
    int recoveries = 0;
    for (int k = 0; k < 33; ++k) recoveries += meet(state, k, shifted(k)) == GateDecision::Recover ? 1 : 0;
    EXPECT_EQ(recoveries, 3);
}

TEST(Gate, ShortClustersDoNotAddUp) {
    // Nine seconds of consistent outliers, one good fix, over and over.
    GateState state;
    for (int k = 0; k < 600; ++k) {
        const bool good = k % 10 == 9;
        EXPECT_EQ(meet(state, k, good ? Vector3d(0.1, 0.0, 0.0) : Vector3d(40.0, 0.0, 0.0)),
                  good ? GateDecision::Accept : GateDecision::Reject);
    }
}

TEST(Gate, WanderingFixesNeverRecover) {
    std::mt19937_64 generator(6);
    std::uniform_real_distribution<double> angle(0.0, 6.28318530717958648);
    const auto anywhere = [&](double) {
        const double a = angle(generator);
        return Vector3d(60.0 * std::cos(a), 60.0 * std::sin(a), 0.0);
    };
    EXPECT_LT(first_recovery(0.0, 1.0, 3000, anywhere), 0.0);
    const auto sides = [](double t) { return Vector3d(static_cast<long>(t) % 2 == 0 ? 30.0 : -30.0, 0.0, 0.0); };
    EXPECT_LT(first_recovery(0.0, 1.0, 3000, sides), 0.0);
}

// An estimate that an outlier captured runs away with a velocity that its covariance does not know.
TEST(Gate, ASteadyDriftAgreesWithItself) {
    EXPECT_DOUBLE_EQ(first_recovery(0.0, 1.0, 300, [](double t) { return Vector3d(50.0 + 15.0 * t, 20.0 - 9.0 * t, 0.0); }),
                     10.0);
    // ... but not one that changes its mind.
    EXPECT_LT(
        first_recovery(0.0, 1.0, 300, [](double t) { return Vector3d(400.0 * std::sin(t), 400.0 * std::cos(2.2 * t), 0.0); }),
        0.0);
}

TEST(Gate, DriftOfTheEstimateExcusesAChange) {
    // The innovation swings by 12 m every second: too much for fixes of 1 m, unless the estimate may move at 2 m/s.
    const auto swinging = [](double t) { return Vector3d(30.0 + (static_cast<long>(t) % 2 == 0 ? 0.0 : 12.0), 0.0, 0.0); };
    EXPECT_LT(first_recovery(0.0, 1.0, 300, swinging, 0.0), 0.0);
    EXPECT_DOUBLE_EQ(first_recovery(0.0, 1.0, 300, swinging, 2.0), 10.0);
}

}  // namespace
}  // namespace schuler::filter
