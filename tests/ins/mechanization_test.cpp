// Both mechanizations against motions known in closed form, and against each other.
#include "exact_motion.h"

#include "schuler/core/units.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace schuler::ins {
namespace {

using Eigen::Vector3d;
using test::ideal_increments;
using test::Jet;
using test::Motion;
using test::Pose;
using test::sensed;

/// Position (m, north east down), velocity (m/s, NED) and attitude (rad) errors, estimate minus truth.
struct Errors {
    Vector3d position, velocity, attitude;
    double horizontal() const { return position.head<2>().norm(); }
};

Errors errors_of(const earth::Earth& earth, const NavState& estimate, const NavStateEcef& truth_e) {
    const NavState truth = to_geographic(earth, truth_e);
    return {earth::ned_difference(earth, estimate.position, truth.position), estimate.v_eb_n - truth.v_eb_n,
            math::rotation_vector_from_quaternion(truth.q_nb * estimate.q_nb.conjugate())};
}

struct Runs {
    Errors n, e;
};

/// Mechanizes increments from the true state at 0; the truth at the end is the motion's.
Runs mechanize(const earth::Earth& earth, const Motion& motion, const std::vector<ImuIncrement>& increments) {
    NavStateEcef e = sensed(earth, motion, 0.0).state;
    NavState n = to_geographic(earth, e);
    const double dt = increments.front().dt;
    ImuIncrement previous = ideal_increments(earth, motion, -dt, dt, 1).front();
    for (const ImuIncrement& current : increments) {
        const CompensatedIncrement increment = compensate(previous, current);
        n = step_n(earth, n, increment);
        e = step_e(earth, e, increment);
        previous = current;
    }
    const NavStateEcef truth = sensed(earth, motion, increments.back().time.seconds()).state;
    EXPECT_EQ(n.time, truth.time);
    EXPECT_NEAR(n.q_nb.norm(), 1.0, 1e-15);
    return {errors_of(earth, n, truth), errors_of(earth, to_geographic(earth, e), truth)};
}

class RestForAnHour : public testing::TestWithParam<double> {};

TEST_P(RestForAnHour, StaysForAnHour) {
    const earth::Earth earth;
    const double lat = GetParam() * units::deg;
    const Motion motion = [lat](const Jet&) { return Pose{lat, -2.5, 800.0, 0.1, -0.2, 2.0}; };
    const double dt = 0.01;
    std::vector<ImuIncrement> increments(360000, ideal_increments(earth, motion, 0.0, dt, 1).front());
    for (std::size_t k = 0; k < increments.size(); ++k) increments[k].time = Time{static_cast<std::int64_t>(k + 1) * 10000000};
    const Runs runs = mechanize(earth, motion, increments);
    // The project's bounds are 1 mm and 1e-6 deg; adding up changes of attitude by themselves leaves far less.
    EXPECT_LT(runs.n.position.norm(), 1e-5);
    EXPECT_LT(runs.e.position.norm(), 1e-5);
    EXPECT_LT(runs.n.attitude.norm(), 1e-10 * units::deg);
    EXPECT_LT(runs.e.attitude.norm(), 1e-10 * units::deg);
    EXPECT_LT(runs.n.velocity.norm(), 1e-8);
    EXPECT_LT(runs.e.velocity.norm(), 1e-8);
}
INSTANTIATE_TEST_SUITE_P(Latitudes, RestForAnHour, testing::Values(0.0, 45.0, -33.0, 78.0, -89.0));

TEST(Mechanization, GreatCircleAtConstantHeight) {
    // Central angle u of a circle inclined by i, at 250 m/s: lat = asin(sin i sin u), lon = atan2(cos i sin u, cos u).
    const earth::Earth earth;
    const double i = 70.0 * units::deg;
    const Motion motion = [i](const Jet& t) {
        const Jet u = 0.3 + t * (250.0 / 6.4e6);
        const Jet lat = asin(std::sin(i) * sin(u));
        const Jet lon = atan2(std::cos(i) * sin(u), cos(u));
        const Jet heading = atan2(Jet(std::cos(i)), std::sin(i) * cos(u));
        return Pose{lat, lon, 10000.0, 0.02, 0.03, heading};
    };
    const Runs runs = mechanize(earth, motion, ideal_increments(earth, motion, 0.0, 0.01, 360000));
    EXPECT_LT(runs.n.position.norm(), 1e-3);
    EXPECT_LT(runs.e.position.norm(), 1e-3);
    EXPECT_LT(runs.n.attitude.norm(), 1e-6 * units::deg);
    EXPECT_LT(runs.e.attitude.norm(), 1e-6 * units::deg);
}

/// A lively flight: 100 m/s, climbs, 30 deg banks at 0.5 to 1.3 rad/s, pitching at 2 rad/s.
Pose flight(const Jet& t) {
    return {0.8 + 2e-3 * sin(0.015 * t) + 3e-5 * sin(0.1 * t),
            0.5 + 2e-5 * t + 3e-3 * cos(0.012 * t),
            1000.0 + 300.0 * sin(0.01 * t) + 20.0 * sin(0.2 * t),
            0.5 * sin(0.5 * t) + 0.2 * sin(1.3 * t),
            0.1 * sin(0.3 * t) + 0.05 * cos(2.0 * t),
            2.0 * sin(0.05 * t) + 0.1 * sin(0.7 * t)};
}

TEST(Mechanization, LivelyFlightForAnHour) {
    const earth::Earth earth;
    const std::vector<ImuIncrement> at200 = ideal_increments(earth, flight, 0.0, 0.005, 720000);
    const Runs fast = mechanize(earth, flight, at200);
    for (const Errors& e : {fast.n, fast.e}) {
        EXPECT_LT(e.horizontal(), 0.1);
        EXPECT_LT(std::abs(e.position.z()), 3.0);
        EXPECT_LT(e.attitude.norm(), 1e-6 * units::deg);
    }
    // The two share no equation but the increments' compensation, whose error they have in common.
    EXPECT_LT((fast.n.position - fast.e.position).norm(), 5e-3);
    EXPECT_LT((fast.n.attitude - fast.e.attitude).norm(), 1e-9 * units::deg);

    // Order of convergence: the compensation's third order prevails over the mechanization's second here.
    const Runs half = mechanize(earth, flight, test::summed(at200, 2));
    const Runs quarter = mechanize(earth, flight, test::summed(at200, 4));
    for (const auto& [fine, coarse] :
         {std::pair{fast.n, half.n}, std::pair{half.n, quarter.n}, std::pair{fast.e, half.e}, std::pair{half.e, quarter.e}}) {
        EXPECT_GT(coarse.horizontal() / fine.horizontal(), 7.0);
        EXPECT_LT(coarse.horizontal() / fine.horizontal(), 9.0);
        EXPECT_GT(coarse.attitude.norm() / fine.attitude.norm(), 7.0);
    }
}

TEST(Mechanization, OrderInTheRateWithExactRotations) {
    // Level flight with a straight body: nothing is left to compensate, what remains is the mechanizations' own second order.
    const earth::Earth earth;
    const Motion motion = [](const Jet& t) {
        return Pose{0.8 + 2e-3 * sin(0.03 * t), 0.5 + 2e-3 * cos(0.02 * t), 1000.0 + 300.0 * sin(0.05 * t), 0.0, 0.0, 1.0};
    };
    const std::vector<ImuIncrement> fine = ideal_increments(earth, motion, 0.0, 0.125, 4800);
    const Runs a = mechanize(earth, motion, test::summed(fine, 2)), b = mechanize(earth, motion, test::summed(fine, 4));
    for (const auto& [small, large] : {std::pair{a.n, b.n}, std::pair{a.e, b.e}}) {
        EXPECT_GT(large.position.norm() / small.position.norm(), 3.5);
        EXPECT_LT(large.position.norm() / small.position.norm(), 9.0);
        EXPECT_LT(small.position.norm(), 0.1);
    }
}

TEST(Mechanization, CrossesTheDateLine) {
    const earth::Earth earth;
    const Motion motion = [](const Jet& t) { return Pose{0.3, 3.14155 + 1e-5 * t, 100.0, 0.0, 0.0, 1.57}; };
    const Runs runs = mechanize(earth, motion, ideal_increments(earth, motion, 0.0, 0.01, 2000));
    EXPECT_LT(runs.n.position.norm(), 1e-5);
    EXPECT_LT(runs.e.position.norm(), 1e-5);
}

TEST(Mechanization, EarthFixedStepWorksAtThePole) {
    const earth::Earth earth;
    const Motion motion = [](const Jet&) { return Pose{90.0 * units::deg, 0.4, 100.0, 0.1, 0.0, 1.0}; };
    const test::Sensed at = sensed(earth, motion, 0.0);
    const CompensatedIncrement increment = compensate({}, ideal_increments(earth, motion, 0.0, 0.01, 1).front());
    NavStateEcef e = at.state;
    for (int k = 0; k < 60000; ++k) e = step_e(earth, e, increment);
    EXPECT_LT((e.position.r - at.state.position.r).norm(), 1e-4);
}

TEST(Mechanization, FrameConversionsInvert) {
    const earth::Earth earth;
    const NavStateEcef e = sensed(earth, flight, 100.0).state;
    const NavStateEcef back = to_ecef(earth, to_geographic(earth, e));
    EXPECT_LT((back.position.r - e.position.r).norm(), 1e-8);
    EXPECT_LT((back.v_eb_e - e.v_eb_e).norm(), 1e-12);
    EXPECT_LT(math::rotation_vector_from_quaternion(back.q_eb * e.q_eb.conjugate()).norm(), 1e-14);
    EXPECT_EQ(back.time, e.time);
}

}  // namespace
}  // namespace schuler::ins
