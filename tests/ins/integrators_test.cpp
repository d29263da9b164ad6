#include "schuler/ins/integrators.h"

#include "exact_motion.h"

#include "schuler/core/units.h"
#include "schuler/earth/axes.h"
#include "schuler/ins/rate_split.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::ins::paper_a {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

const Angles attitude{0.7, 0.3, -1.1};

double largest(const Matrix3d& m) { return m.cwiseAbs().maxCoeff(); }
double distance(const Quaterniond& a, const Quaterniond& b) { return (a.coeffs() - b.coeffs()).norm(); }

TEST(PaperAIntegrators, MatrixAndInitialQuaternionAreTheSameRotation) {
    // B as three turns: psi about up (y), pitch about the turned right axis (z), roll about forward (x).
    const auto turn = [](double angle, const Vector3d& axis) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); };
    const Matrix3d B =
        turn(attitude.psi, Vector3d::UnitY()) * turn(attitude.pitch, Vector3d::UnitZ()) * turn(attitude.roll, Vector3d::UnitX());
    EXPECT_LT(largest(matrix_from(attitude) - B), 1e-15);
    EXPECT_LT(largest(quaternion_from(attitude).toRotationMatrix() - B), 1e-15);
    // In the program's axes: heading is -psi, the other two are the same.
    const Vector3d rpy = math::rpy_from_dcm(earth::C_nb_from(earth::paper_a_chapter1_axes, B));
    EXPECT_LT((rpy - Vector3d(attitude.roll, attitude.pitch, 2.0 * std::numbers::pi - attitude.psi)).norm(), 1e-14);
}

TEST(PaperAIntegrators, PrintedStep) {
    const Quaterniond q(-0.26318142076, -0.209819057797, -0.0999369587265, -0.936335467144);
    const Vector3d beta(0.01, -0.02, 0.015);
    EXPECT_LT(distance(step_quaternion(q, beta), {-0.256085542237, -0.221228486956, -0.100404107885, -0.935626617159}), 2e-12);
    EXPECT_LT(distance(step_picard_second(q, beta, Normalise::No),
                       {-0.256085328238, -0.221228831911, -0.100404122134, -0.935626597027}),
              2e-12);
}

TEST(PaperAIntegrators, LocalErrorsAndGrowthOfTheNorm) {
    const Quaterniond q = quaternion_from(attitude);
    const Vector3d direction(0.48, -0.6, 0.64);
    for (const double size : {0.02, 0.05}) {
        const Vector3d beta = size * direction;
        const Quaterniond second = step_picard_second(q, beta, Normalise::No);
        const Quaterniond first = step_picard_first(q, beta, Normalise::No);
        EXPECT_NEAR(distance(second, step_quaternion(q, beta)) / (std::pow(size, 3) / 48), 1.0, 0.02);
        EXPECT_NEAR((second.norm() - 1.0) / (std::pow(size, 4) / 128), 1.0, 0.02);
        EXPECT_NEAR((first.norm() - 1.0) / (size * size / 8), 1.0, 0.02);
        EXPECT_NEAR(step_picard_second(q, beta, Normalise::Yes).norm(), 1.0, 1e-15);
        EXPECT_NEAR(step_picard_first(q, beta, Normalise::Yes).norm(), 1.0, 1e-15);

        const Matrix3d B = matrix_from(attitude), exact = B * math::dcm_from_rotation_vector(beta);
        const Matrix3d poisson = step_poisson(B, beta, Vector3d::Zero(), Normalise::No);
        EXPECT_LT(largest(poisson - exact), 1.1 * std::pow(size, 3) / 6);
        EXPECT_GT(largest(poisson - exact), 0.3 * std::pow(size, 3) / 6);
        const auto excess = [](const Matrix3d& M) { return (M.transpose() * M - Matrix3d::Identity()).norm() / std::sqrt(2.0); };
        EXPECT_NEAR(excess(poisson) / (std::pow(size, 4) / 4), 1.0, 0.02);
        EXPECT_LT(excess(step_poisson(B, beta, Vector3d::Zero(), Normalise::Yes)), 1e-10);
    }
}

TEST(PaperAIntegrators, GuaranteedOrthogonalityIsNotGuaranteed) {
    // 10^5 steps of 0.05 rad: the norm grows to (1 + 0.05^4/128)^1e5; so much larger is the matrix, squared.
    QuaternionPair pair{quaternion_from(attitude), Quaterniond::Identity()};
    QuaternionPair kept = pair;
    for (int k = 0; k < 100000; ++k) {
        const Vector3d beta(0.05, 0.0, 0.0), zeta(0.0, 0.0, 0.0);
        pair = step_pair(pair, beta, zeta, Normalise::No);
        kept = step_pair(kept, beta, zeta, Normalise::Yes);
    }
    EXPECT_NEAR(pair.lambda.norm(), std::pow(1.0 + std::pow(0.05, 4) / 128, 1e5), 1e-4);
    EXPECT_LT(largest(matrix_from(kept).transpose() * matrix_from(kept) - Matrix3d::Identity()), 1e-14);
}

TEST(PaperAIntegrators, AllFollowOneMotion) {
    // Constant rate of the body and of the local level: B(t) = Exp(-zeta t) B0 Exp(w t), second order in the step for each.
    const Vector3d w(0.3, -0.2, 0.25), level(0.02, -0.01, 0.03);
    const auto true_at = [&](double t) {
        return Matrix3d(math::dcm_from_rotation_vector(-t * level) * matrix_from(attitude) *
                        math::dcm_from_rotation_vector(t * w));
    };
    const Matrix3d exact = true_at(4.0);
    const auto errors = [&](int steps) {
        const double dt = 4.0 / steps;
        Angles angles = attitude;
        Matrix3d B = matrix_from(attitude);
        QuaternionPair pair{quaternion_from(attitude), Quaterniond::Identity()};
        for (int k = 0; k < steps; ++k) {
            // rate relative to the level, in body axes at the middle of the step (exact here)
            angles = step_angles(angles, w - true_at((k + 0.5) * dt).transpose() * level, dt);
            B = step_poisson(B, w * dt, level * dt, Normalise::Yes);
            pair = step_pair(pair, w * dt, level * dt, Normalise::Yes);
        }
        return Vector3d(largest(matrix_from(angles) - exact), largest(B - exact), largest(matrix_from(pair) - exact));
    };
    const Vector3d coarse = errors(200), fine = errors(400);
    EXPECT_LT(coarse.maxCoeff(), 1e-4);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(coarse(k) / fine(k), 4.0, 0.3) << k;
}

TEST(PaperARateSplit, ApproachesTheMechanization) {
    // Ten minutes of a gentle flight, against the exact end. Three rates cost accuracy in proportion to the slow period.
    const earth::Earth earth;
    const test::Motion motion = [](const test::Jet& t) {
        return test::Pose{0.88 + 3e-3 * sin(0.01 * t), 0.5 + 3e-5 * t,       2000.0 + 50.0 * sin(0.02 * t),
                          0.1 * sin(0.1 * t),          0.05 * sin(0.07 * t), 1.2 + 0.3 * sin(0.03 * t)};
    };
    const auto increments = test::ideal_increments(earth, motion, 0.0, 0.01, 60000);
    const NavState start = to_geographic(earth, test::sensed(earth, motion, 0.0).state);
    const NavState end = to_geographic(earth, test::sensed(earth, motion, 600.0).state);
    const auto error = [&](const RateSplit& split) {
        SplitState s = split_from(earth, start);
        for (const ImuIncrement& i : increments) s = split_step(earth, s, i, split);
        return earth::ned_difference(earth, nav_state_of(s).position, end.position).norm();
    };
    const double one_rate = error({1, 1}), three_rates = error({4, 5}), slower = error({4, 10});
    EXPECT_LT(one_rate, 2.0);
    EXPECT_LT(three_rates, 30.0);
    EXPECT_GT(three_rates, 4.0 * one_rate);
    EXPECT_NEAR(slower / three_rates, 2.0, 0.4);
}

}  // namespace
}  // namespace schuler::ins::paper_a
