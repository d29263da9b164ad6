// A start from a fix: the antenna is where the fix says, the unit is a lever arm away, in a direction as uncertain as the attitude.
#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/outputs.h"
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/filter/states/model.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <Eigen/Eigenvalues>

namespace schuler::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

template <class Frame>
void check_start(math::Random& random) {
    Settings settings;
    settings.gnss.lever_arm_b = 3.0 * random.normal3();
    settings.estimate_lever_arm = random.uniform() < 0.5;
    const Recording recording;
    const InertialModel model = make_model(settings, make_layout(settings, recording));
    Start start;
    start.nav.position = {random.uniform() - 0.5, 3.0 * random.uniform(), 100.0};
    start.nav.v_eb_n.setZero();
    start.nav.q_nb = math::quaternion_from_rpy({0.1 * random.normal(), 0.1 * random.normal(), 6.0 * random.uniform()});
    start.std_position = Vector3d(0.02, 0.03, 0.05);
    start.std_velocity = Vector3d::Constant(0.1);
    start.std_rpy = Vector3d(0.02, 0.02, 1.5 * random.uniform());
    start.std_gyro_bias = start.std_accel_bias = Vector3d::Constant(1e-3);
    start.at_antenna = true;
    start.position_of_fix.setOnes();
    start.undecided_heading = 1.5;
    FilterRun<Frame> run;
    set_out(run, model, settings, start, not_given);
    const InertialFilter<Frame>& f = run.filter;
    const Measurement m =
        gnss_position(f.estimate(model), start.nav.position, Vector3d::Constant(1e-4), settings.gnss.lever_arm_b, {});
    // the fix is met, and its sigma is that of the antenna, whatever the attitude
    RC_ASSERT(m.innovation.norm() < 1e-6);
    const Matrix3d S = f.innovation_covariance(f.to_own(model, m));
    for (int i = 0; i < 3; ++i) RC_ASSERT(std::abs(std::sqrt(S(i, i) - 1e-4) / start.std_position(i) - 1.0) < 1e-3);
    // the unit's is not
    const Matrix9 P = f.local_covariance(model);
    const double arm = (start.nav.q_nb * settings.gnss.lever_arm_b).template head<2>().norm() * start.std_rpy.z();
    RC_ASSERT((P(0, 0) + P(1, 1)) > 0.9 * arm * arm);
    if (settings.estimate_lever_arm) RC_ASSERT(P(0, 0) > 1.0);  // m^2, of the lever arm itself
    // a heading that the fixes do not decide moves the reported position of the unit, and not that of the antenna
    const Matrix9 reported = run.covariance(model);
    const double wide = (start.nav.q_nb * settings.gnss.lever_arm_b).template head<2>().norm() * start.undecided_heading;
    RC_ASSERT((reported(0, 0) + reported(1, 1) - P(0, 0) - P(1, 1)) > 0.99 * wide * wide);
    Eigen::Matrix<double, 3, 9> antenna = Eigen::Matrix<double, 3, 9>::Zero();
    antenna.leftCols<3>().setIdentity();
    antenna.rightCols<3>() = math::skew(start.nav.q_nb * settings.gnss.lever_arm_b);
    RC_ASSERT((antenna * (reported - P) * antenna.transpose()).norm() < 1e-6);
    // a solution of the antenna is the fix
    InertialModel there = model;
    there.at_antenna = true;
    const Reported at = filter::reported(there, f, run.undecided(model));
    // the way there and back along the arm differs by its square over the radius of the parallel
    RC_ASSERT(earth::ned_difference(model.earth, at.nav.position, start.nav.position).norm() < 1e-4);
    for (int i = 0; i < 3; ++i) RC_ASSERT(std::abs(std::sqrt(at.P(i, i)) / start.std_position(i) - 1.0) < 1e-3);
    if (const int own = model.layout.lever_arm; own >= 0) {  // what an error of the lever arm alone causes, against differences
        InertialFilter<Frame> turning = f;
        turning.w_ib_b = random.normal3();
        turning.P.setZero();
        const int axis = static_cast<int>(3.0 * random.uniform());
        turning.P(own + axis, own + axis) = 1.0;
        InertialFilter<Frame> longer = turning;
        constexpr double step = 1e-3;  // m
        longer.parameters(own + axis) += step;
        const Reported one = filter::reported(there, turning, Matrix9::Zero()),
                       two = filter::reported(there, longer, Matrix9::Zero());
        const Vector3d place = earth::ned_difference(model.earth, two.nav.position, one.nav.position) / step;
        const Vector3d velocity = (two.nav.v_eb_n - one.nav.v_eb_n) / step;
        RC_ASSERT((one.P.topLeftCorner<3, 3>() - place * place.transpose()).norm() < 1e-3);
        RC_ASSERT((one.P.block<3, 3>(3, 3) - velocity * velocity.transpose()).norm() < 1e-3 * (1.0 + velocity.squaredNorm()));
        RC_ASSERT((one.P.block<3, 3>(0, 3) - place * velocity.transpose()).norm() < 1e-3);
        return;
    }
    // with a known lever arm it is that of a point of the body, also between corrections
    InertialFilter<Frame> turning = f;
    for (int k = 1; k < 4; ++k)
        turning.propagate(model, {Time::from_seconds(0.01 * k), 0.01, 0.01 * random.normal3(), {0.0, 0.0, -0.098}}, {});
    const SolutionRow row = solution_row(filter::reported(there, turning, run.undecided(model)));
    const SolutionRow point = solution_row_at(turning.estimate(model), reported_covariance(model, turning, run.undecided(model)),
                                              settings.gnss.lever_arm_b, Vector3d::Zero());
    RC_ASSERT((row.v_eb_n - point.v_eb_n).norm() < 1e-9);
    RC_ASSERT((row.std_position - point.std_position).norm() < 1e-4 * point.std_position.norm());
}

/// A lever arm turns at the rate of the instant of the fix, not at the mean rate of the step that ends there.
TEST(RateAtTheFix, IsThatOfTheEndOfTheStep) {
    const Settings settings;
    const Recording recording;
    const InertialModel model = make_model(settings, make_layout(settings, recording));
    InertialFilter<GeographicFrame> f(model);
    NavState nav;
    nav.position = {0.8, 0.3, 100.0};
    nav.v_eb_n.setZero();
    nav.q_nb.setIdentity();
    f.set_nav(nav);
    const Vector3d acceleration(0.3, -1.0, 2.0);  // rad/s^2
    double t = 0.0;
    for (const double dt : {0.02, 0.02, 0.01, 0.02}) {  // also where a step is divided at an event
        const Vector3d turned = acceleration * dt * (t + 0.5 * dt);
        t += dt;
        f.propagate(model, {Time::from_seconds(t), dt, turned, {0.0, 0.0, -9.8 * dt}}, {});
        if (t > 0.03) {
            EXPECT_LT((f.w_ib_b - t * acceleration).norm(), 1e-12) << t;
        }
    }
}

/// The rows of an estimated latency are straight lines: it does not move the instant of the rate any more than an unknown one.
TEST(RateAtTheFix, IsAsUncertainByAnEstimatedLatencyAsByAnUnknownOne) {
    Settings settings;
    settings.gnss.lever_arm_b = {0.5, 0.0, -1.0};
    settings.gnss.latency_std = 0.05;
    const Recording recording;
    const InertialModel model = make_model(settings, make_layout(settings, recording));
    InertialFilter<GeographicFrame> f(model);
    NavState nav;
    nav.position = {0.8, 0.3, 100.0};
    nav.v_eb_n.setZero();
    nav.q_nb.setIdentity();
    f.set_nav(nav);
    const double dt = 0.01, w = 60.0;  // s, rad/s
    for (int k = 1; k <= 100; ++k) {
        const Vector3d rate(0.1 * std::cos(w * dt * k), 0.0, 0.0);
        f.propagate(model, {Time::from_seconds(dt * k), dt, rate * dt, {0.0, 0.0, -9.8 * dt}}, {});
    }
    const int latency = model.layout.gnss_latency;
    InertialFilter<GeographicFrame> estimated = f, unknown = f;
    estimated.P(latency, latency) = 0.0;
    estimated.parameters(latency) = 0.01;
    unknown.P(latency, latency) = 1e-4;
    EXPECT_NEAR(estimated.rate_variance(model), unknown.rate_variance(model), 1e-12);
    EXPECT_GT(unknown.rate_variance(model), 5e-4);  // (rad/s)^2: six tenths of a radian of the phase
}

RC_GTEST_PROP(StartAtTheAntenna, KnowsTheAntennaAndNotTheUnit, ()) {
    math::Random random(*rc::gen::arbitrary<std::uint32_t>(), "start");
    check_start<GeographicFrame>(random);
    check_start<EarthFixedFrame>(random);
}

/// Errors of a start are shared by the fix, its slow errors and latencies, and by instruments set by it: no combination of states may
/// have a negative variance.
template <class Frame>
void check_definite(math::Random& random) {
    Settings settings;
    settings.gnss.lever_arm_b = 2.0 * random.normal3();
    settings.estimate_lever_arm = random.uniform() < 0.5;
    settings.gnss.latency_std = 0.15 * random.uniform();
    settings.gnss.velocity_latency_std = 0.15 * random.uniform();
    settings.gnss.errors.correlated_position = 3.0 * random.normal3().cwiseAbs();
    settings.gnss.errors.correlated_velocity = 0.3 * random.normal3().cwiseAbs();
    Recording recording;
    recording.baro.push_back({});
    recording.mag.push_back({});
    recording.heading.push_back({});
    const InertialModel model = make_model(settings, make_layout(settings, recording));
    Start start;
    start.nav.position = {random.uniform() - 0.5, 3.0 * random.uniform(), 500.0};
    start.nav.v_eb_n = 10.0 * random.normal3();
    start.nav.q_nb = math::quaternion_from_rpy({0.1 * random.normal(), 0.1 * random.normal(), 6.0 * random.uniform()});
    start.std_position = 2.0 * random.normal3().cwiseAbs() + Vector3d::Constant(0.01);
    start.std_velocity = 0.3 * random.normal3().cwiseAbs() + Vector3d::Constant(0.01);
    start.std_rpy = Vector3d(0.02, 0.02, 1.5 * random.uniform());
    start.std_gyro_bias = start.std_accel_bias = Vector3d::Constant(1e-3);
    start.position_rate = start.nav.v_eb_n;
    start.velocity_rate = random.normal3();
    start.heading_rate = random.normal();
    start.position_of_fix = start.velocity_of_fix = Vector3d::Ones();
    start.heading_of_mag = random.uniform() < 0.3;
    start.heading_of_sensor = !start.heading_of_mag && random.uniform() < 0.5;
    start.at_antenna = random.uniform() < 0.5;
    FilterRun<Frame> run;
    set_out(run, model, settings, start, 1000.0 * random.normal());
    const auto n = static_cast<Eigen::Index>(model.layout.size);
    const Eigen::MatrixXd P = run.filter.P.topLeftCorner(n, n);
    RC_ASSERT((P - P.transpose()).norm() < 1e-9 * P.norm());
    const Eigen::VectorXd scale = P.diagonal().unaryExpr([](double v) { return v > 0.0 ? 1.0 / std::sqrt(v) : 1.0; });
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> correlations(scale.asDiagonal() * P * scale.asDiagonal());
    RC_ASSERT(correlations.eigenvalues().minCoeff() > -1e-9);
}

RC_GTEST_PROP(StartCovariance, HasNoNegativeVariances, ()) {
    math::Random random(*rc::gen::arbitrary<std::uint32_t>(), "definite");
    check_definite<GeographicFrame>(random);
    check_definite<EarthFixedFrame>(random);
}

}  // namespace
}  // namespace schuler::filter
