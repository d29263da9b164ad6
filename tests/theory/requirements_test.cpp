// Requirement curves against the numbers of docs/math.md 2.9 and against the integrated equations.
#include "schuler/theory/requirements.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::theory {
namespace {

const Pendulum pendulum;

TEST(Requirements, TableForFiveMetres) {
    const struct {
        double t, accel, gyro_deg_h;
        // clang-format off
    } rows[] = {{10, 0.100001283, 630.99956},       {30, 0.0111123939, 23.371793},     {60, 2.77906085e-3, 2.9220813},
                {100, 1.00128371e-3, 0.63148053},   {300, 1.12402765e-4, 0.023532641}, {600, 2.90968346e-5, 3.0033966e-3},
                {1800, 4.76546456e-6, 1.3901694e-4}, {3600, 3.84816e-6, 3.6943620e-5}};   // the last one: the largest before counts
    // clang-format on
    for (const auto& row : rows) {
        const Requirement r = requirement(pendulum, 5.0, row.t);
        EXPECT_NEAR(r.accel / row.accel, 1.0, row.t > 3000 ? 1e-5 : 1e-8) << row.t;
        EXPECT_NEAR(r.gyro / units::deg_per_hour / row.gyro_deg_h, 1.0, 1e-7) << row.t;
    }
    EXPECT_THROW((void)requirement(pendulum, 0.0, 10.0), Error);
    EXPECT_THROW((void)requirement(pendulum, 5.0, -10.0), Error);
}

// r' = v, v' = a - g theta, theta' = v / R + w: the level channel, by Runge and Kutta.
TEST(Requirements, CurvesSolveTheLevelChannel) {
    struct State {
        double r, v, theta;
    };
    const auto run = [](double a, double w, double t) {
        const int n = 4000;
        const double h = t / n;
        State s{0, 0, 0};
        const auto slope = [&](const State& x) { return State{x.v, a - pendulum.g * x.theta, x.v / pendulum.R + w}; };
        const auto at = [](const State& x, const State& d, double f) {
            return State{x.r + f * d.r, x.v + f * d.v, x.theta + f * d.theta};
        };
        for (int i = 0; i < n; ++i) {
            const State k1 = slope(s), k2 = slope(at(s, k1, h / 2)), k3 = slope(at(s, k2, h / 2)), k4 = slope(at(s, k3, h));
            s = at(at(at(at(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
        }
        return s.r;
    };
    for (const double t : {5.0, 15.0, 100.0, 1000.0, 4000.0}) {
        EXPECT_NEAR(pendulum.from_accelerometer(1.0, t) / run(1.0, 0.0, t), 1.0, 1e-9) << t;
        EXPECT_NEAR(-pendulum.from_gyro(1.0, t) / run(0.0, 1.0, t), 1.0, 1e-8) << t;
    }
}

TEST(Requirements, BackwardsFindsTheOutageAgain) {
    const SensorSigmas accel{1.00128371e-3, 0.0, 0.0, 0.0}, gyro{0.0, 3.06150401e-6, 0.0, 0.0};
    EXPECT_NEAR(longest_outage(pendulum, accel, 5.0), 100.0, 1e-5);
    EXPECT_NEAR(longest_outage(pendulum, gyro, 5.0), 100.0, 1e-5);
    EXPECT_NEAR(longest_outage(pendulum, {0.0, 0.0, std::sqrt(3.0) * 5.0 / 1000.0, 0.0}, 5.0), 100.0, 1e-6);
    EXPECT_EQ(longest_outage(pendulum, {1e-9, 0.0, 0.0, 0.0}, 5.0, 7200.0), 7200.0);
}

}  // namespace
}  // namespace schuler::theory
