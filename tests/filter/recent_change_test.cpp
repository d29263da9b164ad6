// What changes within a latency: the rate and the force of a shaken unit, and the velocity of an antenna that turns about it.
#include "schuler/filter/states/recent_change.h"

#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/states/inertial_filter.h"

#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::filter {
namespace {

using Eigen::Vector3d;

/// Change within `time` of a rate of `amplitude` rad/s that oscillates with `frequency` (Hz) about the right axis, at its peak, where it does not change.
double at_the_peak(double frequency, double amplitude, double time) {
    const double w = 2.0 * std::numbers::pi * frequency, dt = 0.001;
    const double end = std::round(5.0 * frequency) / frequency;
    RecentChange recent;
    for (double t = end - 5.0; t <= end; t += dt)
        recent.add({0.5, amplitude * std::cos(w * t), 0.0}, {0.0, -amplitude * w * std::sin(w * t), 0.0}, dt);
    return std::sqrt(recent.total_change_square(time * time, 0.0, dt));
}

TEST(RecentChange, KnowsTheChangeOfAVibrationAtItsPeak) {
    // by acceleration within short times, by twice the variance (amplitude^2 / 2) within long ones
    EXPECT_NEAR(at_the_peak(9.0, 0.1, 0.002), 0.002 * 2.0 * std::numbers::pi * 9.0 * 0.1 / std::sqrt(2.0), 0.001);
    EXPECT_NEAR(at_the_peak(9.0, 0.1, 0.1), 0.1, 0.01);
    EXPECT_NEAR(at_the_peak(20.0, 0.1, 3.0), 0.1, 0.01);
}

/// Mean over seven seconds of the frequency that is found in an oscillation of 0.1 rad/s with noise of the density `psd`.
double frequency_found(double frequency, double psd) {
    const double dt = 0.01, w = 2.0 * std::numbers::pi * frequency;
    math::Random random(6, "frequencies");
    RecentChange recent;
    double sum = 0.0;
    Vector3d before = Vector3d::Zero();
    for (int i = 0; i < 1000; ++i) {
        const Vector3d rate = Vector3d(0.2, 0.1 * std::sin(w * i * dt), 0.0) +
                              std::sqrt(psd / dt) * Vector3d(random.normal(), random.normal(), random.normal());
        recent.add(rate, (rate - before) / dt, dt);
        before = rate;
        if (i >= 300) sum += recent.frequency(psd, dt) / 700.0;
    }
    return sum;
}

TEST(RecentChange, KnowsTheFrequencyOfASwingAndOfAVibration) {
    // the mean over a fifth of a second follows a swing, and differences of samples are less than the derivative of a vibration
    EXPECT_NEAR(frequency_found(1.5, 0.0), 1.8, 0.3);
    EXPECT_NEAR(frequency_found(4.0, 0.0), 4.0, 0.3);
    EXPECT_NEAR(frequency_found(13.0, 0.0), 12.6, 0.3);
    for (const double frequency : {1.5, 4.0})
        EXPECT_NEAR(frequency_found(frequency, 5e-8) / frequency_found(frequency, 0.0), 1.0, 0.1);
    EXPECT_EQ(RecentChange().frequency(0.0, 0.01), std::numeric_limits<double>::infinity());
}

TEST(RecentChange, DoesNotCountTheNoise) {
    const double psd = 1e-6, dt = 0.01;
    math::Random random(4, "rates");
    RecentChange recent;
    Vector3d before = Vector3d::Zero();
    double sum = 0.0;
    for (int i = 0; i < 2000; ++i) {
        const Vector3d rate = std::sqrt(psd / dt) * Vector3d(random.normal(), random.normal(), random.normal());
        recent.add(rate, (rate - before) / dt, dt);
        before = rate;
        if (i > 100) sum += recent.total_change_square(0.02 * 0.02, psd, dt) / 1900.0;
    }
    EXPECT_LT(sum, 0.5 * 6.0 * psd / dt);  // of its change between two times
}

/// A unit in the north-east of the globe with a lever arm and latencies as states.
Estimate estimate_of(const Vector3d& rotation) {
    Estimate e;
    e.layout.lever_arm = e.layout.add("lever_arm", "m", 3);
    e.layout.gnss_latency = e.layout.add("gnss_latency_error", "s", 1);
    e.layout.gnss_velocity_latency = e.layout.add("gnss_velocity_latency_error", "s", 1);
    e.nav.position = {0.8, 0.4, 200.0};
    e.nav.v_eb_n.setZero();
    e.nav.q_nb = math::quaternion_from_rotation_vector(rotation);
    e.C_nb = e.nav.q_nb.toRotationMatrix();
    e.parameters.setZero(e.layout.size);
    return e;
}

/// A velocity of an instant ago is that of the antenna then, which turned about the unit at another rate.
TEST(Measurements, ALateVelocityIsThatOfTheAntenna) {
    math::Random random(5, "antenna");
    for (int k = 0; k < 20; ++k) {
        Estimate e = estimate_of(random.normal3());
        e.nav.v_eb_n = 20.0 * random.normal3();
        e.w_ib_b = 0.3 * random.normal3();
        e.parameters.segment<3>(e.layout.lever_arm) = random.normal3();
        e.a_n = Vector3d(0.5, -0.3, 0.2);
        e.angular_acceleration = Vector3d(2.0, -3.0, 1.0);
        constexpr double late = 1e-4;  // s
        e.parameters(e.layout.gnss_velocity_latency) = late;
        Estimate then = e;
        then.nav.v_eb_n -= late * e.a_n;
        then.C_nb = e.C_nb * math::quaternion_from_rotation_vector(-late * rate_to_earth(e)).toRotationMatrix();
        then.w_ib_b -= late * e.angular_acceleration;
        const Vector3d v_n = -gnss_velocity(then, Vector3d::Zero(), Vector3d::Ones(), Vector3d::Zero(), -1, {}).innovation;
        const Measurement m = gnss_velocity(e, -v_n, Vector3d::Ones(), Vector3d::Zero(), e.layout.gnss_velocity_latency, {});
        EXPECT_LT(m.innovation.norm(), 2.0e-6) << k;  // of 3e-4 m/s
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(
                m.rows[static_cast<std::size_t>(i)](e.layout.gnss_velocity_latency),
                (v_n + gnss_velocity(e, Vector3d::Zero(), Vector3d::Ones(), Vector3d::Zero(), -1, {}).innovation)(i) / -late,
                0.02);
    }
}

/// A body that swings north and south: its force changes by so much within a latency, in the axes of the local level.
template <class Frame>
void expect_change_of_swing() {
    const Estimate e = estimate_of(Vector3d::Zero());
    const InertialModel model(e.earth, e.layout, {});  // no noise
    InertialFilter<Frame> f(model);
    f.set_nav(Frame::from_geographic(e.earth, e.nav));
    constexpr double dt = 0.01, w = 2.0 * std::numbers::pi * 1.0, amplitude = 1.0;  // s, rad/s, m/s^2
    Vector3d brief = Vector3d::Zero(), most = brief;                                // means over a period
    for (int i = 0; i < 1000; ++i) {
        const Vector3d force(amplitude * std::sin(w * i * dt), 0.0, -9.8);
        f.propagate(model, {e.nav.time + Duration::from_seconds(i * dt), dt, Vector3d::Zero(), dt * force}, {});
        if (i < 900) continue;
        brief += f.force_change_square(model, 0.02 * 0.02) / 100.0;
        most += f.force_change_square(model, 100.0) / 100.0;
    }
    EXPECT_NEAR(std::sqrt(brief.sum()), 0.02 * w * amplitude / std::sqrt(2.0), 0.01);
    EXPECT_NEAR(std::sqrt(most.sum()), 0.8 * amplitude, 0.15);  // less than all of it: the mean follows the swing
    // squares do not tell the signs: turned from the axes of the Earth, a part appears in the other directions
    EXPECT_LT(most.tail<2>().sum(), (Frame::errors_are_geographic ? 1e-3 : 2.0) * most.x());
}
TEST(RecentChange, OfTheForceInASwing) {
    expect_change_of_swing<GeographicFrame>();
    expect_change_of_swing<EarthFixedFrame>();
}

}  // namespace
}  // namespace schuler::filter
