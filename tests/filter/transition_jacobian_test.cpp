// The filter's transition against what its own step does to perturbed states: every column, both frames.
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/filter/states/model.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::filter {
namespace {

using Eigen::Vector3d;
using Vector = Eigen::VectorXd;

template <class Frame>
InertialFilter<Frame> filter_at(const InertialModel& model, math::Random& random) {
    InertialFilter<Frame> f(model);
    NavState nav;
    nav.time = Time::from_seconds(100.0);
    nav.position = {1.2 * (2.0 * random.uniform() - 1.0), std::numbers::pi * (2.0 * random.uniform() - 1.0),
                    3000.0 * random.uniform()};
    nav.v_eb_n = 60.0 * random.normal3();
    nav.q_nb = math::quaternion_from_rpy(Vector3d(0.4, 0.4, 2.0).cwiseProduct(random.normal3()));
    f.set_nav(Frame::from_geographic(model.earth, nav));
    for (int i = 9; i < model.layout.size; ++i) f.parameters(i) = 2e-3 * random.normal();
    f.previous = {nav.time, 0.01, Vector3d::Zero(), Vector3d::Zero()};
    return f;
}

/// Error of `a` against `b` in the filter's coordinates: the dx with which a, corrected by it, becomes b.
template <class Frame>
Vector difference(const InertialModel& model, const InertialFilter<Frame>& a, const InertialFilter<Frame>& b) {
    Vector dx = a.parameters - b.parameters;
    // Newton on the correction itself, so that the test shares its coordinates with the filter and nothing else.
    Vector9 d = Vector9::Zero();
    for (int pass = 0; pass < 3; ++pass) {
        const NavState now = Frame::geographic(model.earth, Frame::corrected(model.earth, a.nav, d));
        const NavState aim = Frame::geographic(model.earth, b.nav);
        Vector9 rest;
        rest.segment<3>(0) = earth::ned_difference(model.earth, now.position, aim.position);
        rest.segment<3>(3) = now.v_eb_n - aim.v_eb_n;
        // q_now = (I - [phi]) q_aim for an attitude error phi of the estimate.
        rest.segment<3>(6) = -math::rotation_vector_from_quaternion(now.q_nb * aim.q_nb.conjugate());
        InertialFilter<Frame> at = a;
        at.set_nav(Frame::corrected(model.earth, a.nav, d));
        d += at.to_local_level(model).fullPivLu().solve(rest);
    }
    dx.head<9>() = d;
    return dx;
}

/// Every state that acts on a step but gravity's.
Settings sensors_and_arms() {
    Settings settings;
    settings.scale_factors = settings.misalignments = settings.estimate_lever_arm = settings.constraints.nonholonomic = true;
    settings.gnss.errors.correlated_velocity.setOnes();
    return settings;
}
Settings with_gravity(DisturbanceKind kind, DisturbanceAxes axes) {
    Settings settings;
    settings.disturbance.estimate = true;
    settings.disturbance.model = {kind, 0.5, Vector3d::Constant(1e-3), true, axes};  // by time: the pace is constant
    return settings;
}

template <class Frame>
void check(const Settings& settings, int states) {
    Recording recording;
    recording.baro.resize(1);
    recording.mag.resize(1);
    const Layout layout = make_layout(settings, recording);
    ASSERT_EQ(layout.size, states);
    const int N = estim::padded(states);
    sensor::ImuErrorModel errors = sensor::imu_grade("mems");
    errors.gyro_turn_on_bias = errors.accel_turn_on_bias = 0.0;  // biases decay
    errors.gyro_bias_time = errors.accel_bias_time = 50.0;
    InertialModel model(settings.earth, layout, errors);
    model.disturbance = settings.disturbance.model;
    math::Random random(5, "transition");
    constexpr double dt = 0.002;
    for (int trial = 0; trial < 5; ++trial) {
        const InertialFilter<Frame> start = filter_at<Frame>(model, random);
        const ImuIncrement inc{start.time() + Duration::from_seconds(dt), dt, dt * 0.5 * random.normal3(),
                               dt * (Vector3d(0, 0, -9.8) + 3.0 * random.normal3())};
        estim::Transition phi, unused;
        InertialFilter<Frame> nominal = start;
        nominal.P = 1e-12 * StateMatrix::Identity(N, N);  // a known heading: nothing is withheld from its column
        nominal.propagate(model, inc, {});
        (void)nominal.propagate_covariance(model, phi);
        for (int i = 0; i < states; ++i) {
            const double step = i < 3 ? 50.0 : i < 6 ? 0.05 : i < 9 ? 1e-4 : 1e-3;
            Vector moved[2];
            for (const int side : {0, 1}) {
                InertialFilter<Frame> f = start;
                StateVector dx = StateVector::Zero(N);
                dx(i) = side == 0 ? -step : step;
                f.apply(model, dx);  // subtracts: an error of -dx
                f.propagate(model, inc, {});
                (void)f.propagate_covariance(model, unused);
                moved[side] = difference(model, f, nominal);
            }
            const Vector numeric = (moved[0] - moved[1]) / (2.0 * step);
            const Vector analytic = phi.times(StateVector::Unit(N, i));
            const StateVector row = phi.transpose_times(StateVector::Unit(N, i));  // and its transpose agrees with it
            for (int r = 0; r < N; ++r) EXPECT_NEAR(row(r), phi.times(StateVector::Unit(N, r))(i), 1e-15) << r << " " << i;
            // The filter's Phi is of first order in the step; what it leaves out is of second.
            for (int r = 0; r < N; ++r) {
                const double size = (r < 6 ? 20.0 : 1.0) / (i < 3 ? 1e5 : 1.0);  // of an element of F^2 or of its turn in a step
                EXPECT_NEAR(numeric(r), analytic(r),
                            2.0 * dt * dt * size + 1e-3 * std::abs(analytic(r) - (r == i ? 1.0 : 0.0)) + 1e-12)
                    << "row " << r << " column " << i << " trial " << trial;
            }
        }
    }
}

TEST(FilterTransition, OfTheGeographicFrameMatchesItsStep) { check<GeographicFrame>(sensors_and_arms(), 48); }
TEST(FilterTransition, OfTheEarthFixedFrameMatchesItsStep) { check<EarthFixedFrame>(sensors_and_arms(), 48); }

TEST(FilterTransition, OfGravityMatchesItsStep) {
    const auto both = [](DisturbanceKind kind, int states) {
        check<GeographicFrame>(with_gravity(kind, DisturbanceAxes::EarthFixed), states);
        check<EarthFixedFrame>(with_gravity(kind, DisturbanceAxes::LocalLevel), states);
    };
    both(DisturbanceKind::Constant, 24);
    both(DisturbanceKind::FirstOrder, 27);
    both(DisturbanceKind::QuadraticAndFirstOrder, 33);
    both(DisturbanceKind::SecondOrder, 30);
    both(DisturbanceKind::ThirdOrder, 33);
}

}  // namespace
}  // namespace schuler::filter
