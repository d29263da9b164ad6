// The integral of the velocity's error over the spans behind, told by the errors of now.
#include "schuler/filter/mean_velocity.h"

#include "schuler/filter/layout.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::filter {
namespace {

using estim::StateVector;

// Whatever the errors and however they have moved: the rows give the integral along their way, which the errors of now alone determine.
TEST(MeanVelocity, RowsAreTheIntegralAlongTheWay) {
    constexpr int states = 20, spans = 7;
    math::Random random(4, "mean velocity");
    for (int trial = 0; trial < 20; ++trial) {
        StateVector x(states);
        for (int i = 0; i < states; ++i) x(i) = random.normal();
        MeanVelocity mean;
        mean.begin(states, Eigen::Vector3d::Zero());
        Eigen::Vector3d integral = Eigen::Vector3d::Zero();
        double time = 0.0;
        for (int k = 0; k < spans; ++k) {
            estim::Transition phi;
            phi.driven = 16;
            phi.diagonal = StateVector::Ones(states);
            for (int c = 0; c < phi.driven; ++c)
                for (int r = 0; r < estim::Transition::coupled; ++r) phi.rows(c, r) = (c == r ? 1.0 : 0.0) + 0.1 * random.normal();
            const double dt = 0.02 * (1.0 + random.uniform());
            integral += 0.5 * dt * x.segment<3>(Layout::velocity);
            x = phi.times(x);
            integral += 0.5 * dt * x.segment<3>(Layout::velocity);
            time += dt;
            mean.follow(phi, dt, 0.0, 0.0, 9.8);
        }
        EXPECT_NEAR(mean.time, time, 1e-15);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(mean.rows[i].dot(x), integral(static_cast<int>(i)), 1e-12);
    }
}

// Corrections within the span are carried: less them the estimate has gone as far as one with the errors of the end from the begin on.
TEST(MeanVelocity, CorrectionsCountAsIfKnownFromTheBegin) {
    constexpr int states = 16, spans = 9;
    constexpr double dt = 0.02;
    math::Random random(11, "corrections");
    for (int trial = 0; trial < 20; ++trial) {
        StateVector x(states);   // errors of the estimate
        for (int i = 0; i < states; ++i) x(i) = random.normal();
        const Eigen::Vector3d at_begin = x.head<3>();
        MeanVelocity mean;
        mean.begin(states, Eigen::Vector3d::Zero());
        for (int k = 0; k < spans; ++k) {
            estim::Transition phi;
            phi.driven = 16;
            phi.diagonal = StateVector::Ones(states);
            for (int r = 3; r < estim::Transition::coupled; ++r)
                for (int c = 3; c < phi.driven; ++c) phi.rows(c, r) = (c == r ? 1.0 : 0.0) + 0.05 * random.normal();
            for (int i = 0; i < 3; ++i) {   // the position moves by the mean of the velocities at either end
                phi.rows.col(i) = 0.5 * dt * phi.rows.col(Layout::velocity + i);
                phi.rows(Layout::velocity + i, i) += 0.5 * dt;
                phi.rows(i, i) += 1.0;
            }
            x = phi.times(x);
            mean.follow(phi, dt, 0.0, 0.0, 9.8);
            if (k != 3 && k != 6) continue;
            StateVector dx(states);
            for (int i = 0; i < states; ++i) dx(i) = random.normal();
            mean.correct(dx);
            x -= dx;
        }
        const Eigen::Vector3d gone = x.head<3>() - at_begin;   // wrongly
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(gone(i) - mean.carried(i), mean.rows[static_cast<std::size_t>(i)].dot(x), 1e-10) << trial;
        EXPECT_GT(mean.carried.norm(), 1e-2) << trial;
    }
}

// White noise on velocity and attitude that the errors of now do not show when it came: the mean square of what the rows are then wrong by.
TEST(MeanVelocity, NoiseWithinTheSpanIsKnown) {
    constexpr int states = 16, spans = 20, runs = 4000;
    constexpr double dt = 0.01, force = 30.0, velocity_walk = 1e-6, attitude_walk = 4e-9;
    estim::Transition phi;   // a force along the first axis turns errors about the third into velocity along the second
    phi.driven = 16;
    phi.diagonal = StateVector::Ones(states);
    for (int i = 0; i < estim::Transition::coupled; ++i) phi.rows(i, i) = 1.0;
    phi.rows(Layout::attitude + 2, Layout::velocity + 1) = -force * dt;
    math::Random random(7, "noise");
    double squares = 0.0, stated = 0.0;
    for (int run = 0; run < runs; ++run) {
        StateVector x = StateVector::Zero(states);
        MeanVelocity mean;
        mean.begin(states, Eigen::Vector3d::Zero());
        double integral = 0.0;
        for (int k = 0; k < spans; ++k) {
            integral += 0.5 * dt * x(Layout::velocity + 1);
            x = phi.times(x);
            integral += 0.5 * dt * x(Layout::velocity + 1);
            x(Layout::velocity + 1) += std::sqrt(velocity_walk) * random.normal();
            x(Layout::attitude + 2) += std::sqrt(attitude_walk) * random.normal();
            mean.follow(phi, dt, velocity_walk, attitude_walk, force);
        }
        squares += std::pow(mean.rows[1].dot(x) - integral, 2) / runs;
        stated = mean.noise;
    }
    EXPECT_NEAR(squares / stated, 1.0, 0.15);   // the noise comes at the ends of the steps here, in their middle there: 0.07
}

}  // namespace
}  // namespace schuler::filter
