// Heading from horizontal acceleration: none in straight motion, all of it in a real manoeuvre.
#include "schuler/filter/states/heading_force.h"

#include "schuler/core/units.h"
#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/filter/states/model.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace schuler::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

RC_GTEST_PROP(HeadingForce, NothingIsLostAndNothingIsInvented, ()) {
    math::Random random(*rc::gen::arbitrary<std::uint32_t>(), "force");
    const Vector3d down = random.normal3().normalized(), change = random.normal3(), before = random.normal3();
    const double sigma = std::pow(10.0, 3.0 * random.uniform() - 2.0), heading = std::pow(10.0, 4.0 * random.uniform() - 3.0);
    const Withheld past{before, 10.0, 0.3, 0.01};
    const HeadingForce f = heading_force(change, past, down, sigma * sigma * Matrix3d::Identity(), heading * heading);
    const auto level = [&](const Vector3d& v) { return Vector3d(v - down.dot(v) * down); };
    const Withheld& now = f.withheld;
    Vector3d held = level(before);
    if (held.norm() > now.limit) held *= now.limit / held.norm();
    RC_ASSERT((f.effective + now.change - held - level(change)).norm() < 1e-12);
    RC_ASSERT(now.change.norm() <= now.limit + 1e-12);
    // two sigma of the horizontal velocity less the noise already counted, and less where the heading is known
    const double bound = std::min(0.5, 2.0 * std::sqrt(std::max(0.0, 2.0 * sigma * sigma - 0.01)));
    RC_ASSERT(now.limit <= bound + 1e-12);
    if (heading > 0.1) RC_ASSERT(std::abs(now.limit - bound) < 1e-9);
    if (heading < 0.035) RC_ASSERT(now.limit == 0.0);
    // the error made is across what is withheld: an error of the heading by psi turns it by psi; it is counted once
    RC_ASSERT((f.velocity_noise * down).norm() < 1e-9);
    RC_ASSERT((f.velocity_noise * now.change).norm() < 1e-9);
    const double counted = std::min(0.3, now.limit), grown = std::max(0.0, now.change.squaredNorm() - counted * counted);
    RC_ASSERT(std::abs(f.velocity_noise.trace() - std::min(1.0, heading * heading) * grown) < 1e-9);
}

TEST(HeadingForce, OfAKnownHeadingIsTheWholeAcceleration) {
    const Vector3d change(0.01, -0.02, 0.3);
    const HeadingForce f = heading_force(change, {}, Vector3d::UnitZ(), Matrix3d::Identity(), 0.0);
    EXPECT_EQ(f.effective, Vector3d(0.01, -0.02, 0.0));
    EXPECT_TRUE(f.velocity_noise.isZero(0.0));
}

/// A vehicle of given heading whose velocity is `velocity(t)`, with a unit of consumer grade and RTK velocities five times a second:
/// errors of heading and their sigmas at the end of 60 s, from starts that are wrong by a random angle of sigma 45 deg.
template <class Frame, class Velocity>
std::pair<double, double> heading_after(Velocity&& velocity, const Vector3d& lever_arm = Vector3d::Zero()) {
    constexpr double dt = 0.02, heading = 1.3, duration = 60.0, of_velocity = 0.03, of_heading = 0.8, of_level = 0.01;
    constexpr int runs = 40;
    Settings settings;
    Recording recording;
    const sensor::ImuErrorModel errors = sensor::imu_grade("consumer");
    const Layout layout = make_layout(settings, recording);
    InertialModel model(settings.earth, layout, errors);
    model.lever_arm_b = lever_arm;
    math::Random random(7, "straight");
    double nees = 0.0, variance = 0.0;
    for (int run = 0; run < runs; ++run) {
        NavState truth;
        truth.time = Time{0};
        truth.position = {0.9, 0.5, 100.0};
        truth.v_eb_n = velocity(0.0);
        truth.q_nb = math::quaternion_from_rpy(Vector3d(0.0, 0.0, heading));
        const Matrix3d C = truth.q_nb.toRotationMatrix();
        NavState start = truth;
        start.q_nb = math::quaternion_from_rpy(
            Vector3d(of_level * random.normal(), of_level * random.normal(), heading + of_heading * random.normal()));
        InertialFilter<Frame> f(model);
        f.set_nav(Frame::from_geographic(model.earth, start));
        f.previous = {start.time, dt, Vector3d::Zero(), Vector3d::Zero()};
        Vector9 sigma;
        sigma << 5.0, 5.0, 5.0, Vector3d::Constant(of_velocity), of_level, of_level, of_heading;
        const Matrix9 to_own = f.to_local_level(model).inverse();
        f.P.template topLeftCorner<9, 9>() = to_own * sigma.cwiseAbs2().asDiagonal() * to_own.transpose();
        const double gyro_bias = errors.gyro_turn_on_bias, accel_bias = errors.accel_turn_on_bias;
        f.P.diagonal().template segment<3>(Layout::gyro_bias).setConstant(gyro_bias * gyro_bias);
        f.P.diagonal().template segment<3>(Layout::accel_bias).setConstant(accel_bias * accel_bias);
        const Vector3d b_g = gyro_bias * random.normal3(), b_a = accel_bias * random.normal3();
        for (int k = 1; k <= static_cast<int>(duration / dt); ++k) {
            const Vector3d v0 = velocity(dt * (k - 1)), v1 = velocity(dt * k);
            const earth::EarthTerms t = earth::terms_at(model.earth, truth.position, 0.5 * (v0 + v1));
            const Vector3d f_n = (v1 - v0) / dt - t.g_n + (2.0 * t.w_ie_n + t.w_en_n).cross(0.5 * (v0 + v1));
            const Vector3d w_b = C.transpose() * (t.w_ie_n + t.w_en_n);
            const double root = std::sqrt(dt);
            f.propagate(model,
                        {Time::from_seconds(dt * k), dt, dt * (w_b + b_g) + root * errors.gyro_noise * random.normal3(),
                         dt * (C.transpose() * f_n + b_a) + root * errors.accel_noise * random.normal3()},
                        {});
            estim::Transition phi;
            if (k % 5 == 0) (void)f.propagate_covariance(model, phi);
            truth.position = earth::moved_by_ned(model.earth, truth.position, 0.5 * dt * (v0 + v1));
            if (k % 10 != 0) continue;
            if (!lever_arm.isZero(0.0)) {
                const Geodetic antenna =
                    earth::moved_by_ned(model.earth, truth.position, C * lever_arm + 0.02 * random.normal3());
                const Measurement m = gnss_position(f.estimate(model), antenna, Vector3d::Constant(4e-4), lever_arm, {});
                (void)f.update(model, f.to_own(model, m), [](const auto&) {});
            }
            const Measurement m = gnss_velocity(f.estimate(model), v1 + of_velocity * random.normal3(),
                                                Vector3d::Constant(of_velocity * of_velocity), lever_arm, -1, {});
            (void)f.update(model, f.to_own(model, m), [](const auto&) {});
        }
        const double error = math::wrap_pi(math::rpy_from_dcm(f.geographic(model).q_nb.toRotationMatrix()).z() - heading);
        const double P = f.local_covariance(model)(Layout::attitude + 2, Layout::attitude + 2);
        nees += error * error / P / runs;
        variance += P / runs;
    }
    return {nees, std::sqrt(variance)};
}

template <class Frame>
void check_straight() {
    const auto [nees, sigma] = heading_after<Frame>([](double) { return Vector3d(2.0, 7.0, 0.0); });
    EXPECT_GT(sigma, 0.75);  // as before, for nothing was learnt
    EXPECT_LT(nees, 2.5);    // chi-square of 40, and angles near half a turn
}
TEST(StraightMotion, TellsNoHeading) { check_straight<GeographicFrame>(); }
/// Each correction of the heading moves the antenna about the unit, and the errors of the gyros turn it: neither is a motion that
/// fixes of a centimetre and velocities could confirm.
template <class Frame>
void check_eccentric() {
    for (const Vector3d& arm : {Vector3d(0.4, -0.2, -1.1), Vector3d(3.0, 0.8, -2.0)}) {
        const auto [nees, sigma] = heading_after<Frame>([](double) { return Vector3d(2.0, 7.0, 0.0); }, arm);
        EXPECT_GT(sigma, 0.6) << arm.transpose();
        EXPECT_LT(nees, 3.0) << arm.transpose();
    }
}
TEST(StraightMotion, TellsNoHeadingByALeverArm) {
    check_eccentric<GeographicFrame>();
    check_eccentric<EarthFixedFrame>();
}
TEST(StraightMotion, TellsNoHeadingInTheEarthFixedFrame) { check_straight<EarthFixedFrame>(); }

TEST(StraightMotion, AGentleAccelerationTellsTheHeading) {
    // 0.3 m/s^2 along a leg and back, every 20 s
    const auto [nees, sigma] = heading_after<GeographicFrame>([](double t) {
        const double leg = std::fmod(t, 20.0);
        return Vector3d(0.0, 5.0 + 0.3 * (leg < 10.0 ? leg : 20.0 - leg), 0.0);
    });
    EXPECT_LT(sigma, 0.1);
    EXPECT_LT(nees, 3.0);
}

}  // namespace
}  // namespace schuler::filter
