// The whole survey: simulated instruments over a disturbance, filter and smoother, against the truth and against their own sigmas.
#include "gravimetry/prepared_survey.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::gravimetry {
namespace {

using Eigen::Vector3d;
using test::Beliefs;
using test::erring_start;
using test::Prepared;

constexpr double gyro = 0.01 * units::deg_per_hour;
const Geodetic start{55.8114694 * units::deg, 37.4998612 * units::deg, 164.15};

/// Paper E's instruments with a carrier-phase receiver at the IMU, twice and once a second.
sim::Scenario papers_scenario(const sim::PathSettings& path, double duration, std::uint64_t seed) {
    sim::Scenario s;
    s.seed = seed;
    s.duration = duration;
    s.path = path;
    s.reference_rate = 1.0;
    s.imu.rate = 2.0;
    s.imu.errors.gyro_turn_on_bias = gyro;
    s.imu.errors.gyro_noise = gyro / std::sqrt(s.imu.rate);
    s.imu.errors.accel_turn_on_bias = 1e-6;
    s.imu.errors.accel_noise = 1e-6 / std::sqrt(s.imu.rate);
    s.gnss.white_position.setConstant(0.05);
    s.gnss.white_velocity.setConstant(0.05);
    s.gnss.errors.correlated_position.setConstant(0.05);
    s.gnss.errors.correlated_velocity.setConstant(0.05);
    s.gnss.errors.correlated_time = s.gnss.errors.correlated_velocity_time = 1e15;
    return s;
}
Beliefs papers_beliefs() {
    Beliefs b;
    const sim::Scenario s = papers_scenario(sim::StaticPath{}, 1.0, 1);
    b.settings.imu.errors = s.imu.errors;
    b.settings.gnss.errors = s.gnss.errors;
    b.attitude_n = {1e-4, 1e-4, 1e-3};
    b.gyro_bias = gyro;
    return b;
}

struct Flown {
    sim::SimulatedData data;
    SurveyResult result;
    /// At the i-th fix of the result; the truth has the start too.
    [[nodiscard]] const Vector3d& truth(std::size_t i) const { return data.sensor_truth[i + 1].disturbance_n; }
};
Flown run(const sim::Scenario& scenario, const Beliefs& beliefs) {
    Flown out{sim::simulate(scenario), {}};
    out.result = Prepared(scenario, out.data, beliefs, erring_start(scenario, out.data, beliefs)).run();
    return out;
}

double median(std::vector<double> x) {
    std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
    return x[x.size() / 2];
}

// What run.h5 has of every state is what the epochs say.
TEST(Survey, KeepsEveryState) {
    sim::Scenario scenario = papers_scenario(sim::GreatCirclePath{start, 45.0 * units::deg, std::sqrt(2.0)}, 300.0, 3);
    Beliefs beliefs = papers_beliefs();
    beliefs.settings.covariance_rows = true;
    const SurveyResult r = run(scenario, beliefs).result;
    ASSERT_EQ(r.parameters.size(), r.forward.size());
    ASSERT_EQ(r.covariances.size(), r.forward.size());
    ASSERT_EQ(r.smoothed_parameters.size(), r.smoothed.size());
    const auto bias = std::ranges::find(r.states, "accel_bias", &filter::LayoutBlock::name);
    ASSERT_NE(bias, r.states.end());
    const auto first = static_cast<std::size_t>(bias->offset - 9);
    for (std::size_t i : {std::size_t{0}, r.forward.size() / 2, r.forward.size() - 1}) {
        EXPECT_EQ(r.parameters[i].time, r.forward[i].time);
        EXPECT_EQ(r.smoothed_parameters[i].time, r.smoothed[i].time);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto axis = static_cast<Eigen::Index>(k);
            EXPECT_EQ(r.parameters[i].value[first + k], r.forward[i].accel_bias(axis));
            EXPECT_EQ(r.parameters[i].std[first + k], r.forward[i].sigma_accel_bias(axis));
            EXPECT_EQ(r.smoothed_parameters[i].std[first + k], r.smoothed[i].sigma_accel_bias(axis));
        }
    }
}

TEST(SurveySlow, ConstantDisturbanceOfThePapersScenario) {
    // Half an hour of the car. The disturbance is drawn from its prior; its level cannot be better than the accelerometer's error.
    const Beliefs beliefs = papers_beliefs();
    const sim::GreatCirclePath path{start, 45.0 * units::deg, std::sqrt(2.0)};
    std::vector<double> errors;
    double nees = 0.0, nees_smoothed = 0.0;
    const int seeds = 48;
    for (int seed = 1; seed <= seeds; ++seed) {
        math::Random random(static_cast<std::uint64_t>(seed), "disturbance");
        const sim::AnomalyPart constant{sim::AnomalyPart::Kind::Constant, 1e-4 * random.normal3()};
        sim::Scenario scenario = papers_scenario(path, 1800.0, static_cast<std::uint64_t>(seed));
        scenario.anomaly = {constant};
        const Flown r = run(scenario, beliefs);
        const SurveyEpoch& last = r.result.forward.back();
        const SurveyEpoch& middle = r.result.smoothed[300];
        const double error = last.disturbance_n.z() - r.data.sensor_truth.back().disturbance_n.z();
        const double smoothed_error = middle.disturbance_n.z() - r.truth(300).z();
        errors.push_back(std::abs(error));
        nees += std::pow(error / last.sigma_disturbance_n.z(), 2) / seeds;
        nees_smoothed += std::pow(smoothed_error / middle.sigma_disturbance_n.z(), 2) / seeds;
        EXPECT_LT(middle.sigma_disturbance_n.z(), 1.02e-6);  // the whole hour's knowledge, ten minutes in
        EXPECT_LT(last.sigma_attitude_n.x(), 2.2 * units::arcsec);
    }
    EXPECT_LT(median(errors), 0.1 * units::mgal);
    EXPECT_GT(nees, 0.55);  // chi-square of 48, 99 %
    EXPECT_LT(nees, 1.60);
    EXPECT_GT(nees_smoothed, 0.55);
    EXPECT_LT(nees_smoothed, 1.60);
    RecordProperty("median_mgal", std::to_string(median(errors) / units::mgal));
    RecordProperty("nees", std::to_string(nees));
    RecordProperty("nees_smoothed", std::to_string(nees_smoothed));
}

TEST(SurveySlow, AnomalyThatChangesAlongTheTrack) {
    // 60 m/s over a second-order process of 5 km: filter and smoother stay within their sigmas, and the smoother is the better.
    Beliefs beliefs = papers_beliefs();
    beliefs.disturbance.prior_n.setConstant(1e-5);
    beliefs.disturbance.model = {filter::DisturbanceKind::SecondOrder, 5000.0, Vector3d::Constant(3e-4), false};
    const sim::AnomalyPart field{sim::AnomalyPart::Kind::GaussMarkov2, Vector3d::Constant(3e-4), 0.0, 5000.0};
    double forward = 0.0, smoothed = 0.0, nees = 0.0, nees_smoothed = 0.0;
    int count = 0;
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
        sim::Scenario scenario = papers_scenario(sim::GreatCirclePath{start, 0.5, 60.0}, 1200.0, seed);
        scenario.anomaly = {field};
        const Flown r = run(scenario, beliefs);
        for (std::size_t i = 200; i < 1000; i += 40, ++count) {
            const double truth = r.truth(i).z();
            const SurveyEpoch &f = r.result.forward[i], &s = r.result.smoothed[i];
            const double ef = f.disturbance_n.z() - truth, es = s.disturbance_n.z() - truth;
            forward += ef * ef;
            smoothed += es * es;
            nees += std::pow(ef / f.sigma_disturbance_n.z(), 2);
            nees_smoothed += std::pow(es / s.sigma_disturbance_n.z(), 2);
        }
    }
    nees /= count;
    nees_smoothed /= count;
    EXPECT_LT(smoothed, 0.25 * forward);
    EXPECT_GT(nees, 0.6);
    EXPECT_LT(nees, 1.6);
    EXPECT_GT(nees_smoothed, 0.5);
    EXPECT_LT(nees_smoothed, 1.7);
    RecordProperty("forward_mgal", std::to_string(std::sqrt(forward / count) / units::mgal));
    RecordProperty("smoothed_mgal", std::to_string(std::sqrt(smoothed / count) / units::mgal));
    RecordProperty("nees", std::to_string(nees));
    RecordProperty("nees_smoothed", std::to_string(nees_smoothed));
}

// Second-order process, so that a state of it changes sign in reversed time. Forward and backward filter are compared with the truth,
// and their difference with its sigma, from which the common priors are taken out.
TEST(Survey, TheFilterBackwardInTimePartsFromTheForwardOneAsItsSigmaTells) {
    Beliefs beliefs = papers_beliefs();
    beliefs.attitude_n.setConstant(1e-4);
    beliefs.disturbance.prior_n.setConstant(5e-5);
    beliefs.disturbance.model = {filter::DisturbanceKind::SecondOrder, 5000.0, Vector3d::Constant(3e-4), false};
    Vector3d parted = Vector3d::Zero(), backward = Vector3d::Zero(), gyros = Vector3d::Zero(), sum = Vector3d::Zero();
    int count = 0;
    const int seeds = 16;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        math::Random random(seed, "disturbance");
        sim::Scenario scenario = papers_scenario(sim::GreatCirclePath{start, 0.5, 60.0}, 800.0, seed);
        scenario.anomaly = {{sim::AnomalyPart::Kind::GaussMarkov2, Vector3d::Constant(3e-4), 0.0, 5000.0},
                            {sim::AnomalyPart::Kind::Constant, 5e-5 * random.normal3()}};
        const sim::SimulatedData data = sim::simulate(scenario);
        const Prepared prepared(scenario, data, beliefs, erring_start(scenario, data, beliefs));
        const SurveyResult r = prepared.run({.smooth = false, .backward = true});
        ASSERT_GT(r.separation.size() + 3, r.forward.size());
        ASSERT_EQ(r.separation.size(), r.backward.size());
        for (std::size_t i = 200; i < 640; i += 40, ++count) {
            const SurveySeparation& d = r.separation[i];
            const SurveyEpoch& b = r.backward[i];
            EXPECT_EQ(d.time, b.time);
            const auto f = std::ranges::find(r.forward, d.time, &SurveyEpoch::time);
            ASSERT_NE(f, r.forward.end());
            EXPECT_LT((f->disturbance_n - b.disturbance_n - d.difference_n).norm(), 1e-15);
            const auto truth = std::ranges::find(data.sensor_truth, d.time, &sim::SensorTruth::time);
            ASSERT_NE(truth, data.sensor_truth.end());
            parted += d.difference_n.cwiseQuotient(d.sigma_n).cwiseAbs2();
            backward += (b.disturbance_n - truth->disturbance_n).cwiseQuotient(b.sigma_disturbance_n).cwiseAbs2();
            gyros += (b.gyro_bias - truth->gyro_bias).cwiseQuotient(b.sigma_gyro_bias).cwiseAbs2();
            sum += d.sigma_n.cwiseQuotient((f->sigma_disturbance_n.cwiseAbs2() + b.sigma_disturbance_n.cwiseAbs2()).cwiseSqrt());
            EXPECT_GT(b.nav.v_eb_e.dot(f->nav.v_eb_e), 3000.0);
        }
    }
    for (int k = 0; k < 3; ++k) {
        for (const Vector3d& mean : {Vector3d(parted / count), Vector3d(backward / count), Vector3d(gyros / count)}) {
            EXPECT_GT(mean(k), 0.5) << k;
            EXPECT_LT(mean(k), 1.7) << k;
        }
    }
    // What both hold of the horizontal level is mostly the prior; a vertical slope that one filter lags behind the other runs ahead of.
    sum /= count;
    EXPECT_LT(sum.x(), 0.8);
    EXPECT_LT(sum.y(), 0.8);
    EXPECT_GT(sum.z(), 1.05);
}

/// No noise, no errors: what is left is the discretisation.
Beliefs perfect_beliefs() {
    Beliefs b;
    b.settings.imu.errors.gyro_noise = 1e-11;
    b.settings.imu.errors.accel_noise = 1e-8;
    b.attitude_n.setConstant(1e-9);
    b.position = 1e-3;
    b.velocity = 1e-4;
    b.accel_bias = b.gyro_bias = 0.0;
    return b;
}
sim::Scenario perfect_scenario(const sim::AnomalyPart& anomaly, double duration) {
    sim::Scenario scenario = papers_scenario(sim::GreatCirclePath{start, 0.5, 10.0}, duration, 1);
    scenario.imu.errors = {};
    scenario.gnss.errors = {};
    scenario.gnss.white_position.setConstant(1e-3);
    scenario.gnss.white_velocity.setConstant(1e-6);
    scenario.anomaly = {anomaly};
    return scenario;
}
Flown perfectly_flown(const sim::AnomalyPart& anomaly, const filter::DisturbanceModel& model, double prior) {
    Beliefs beliefs = perfect_beliefs();
    beliefs.disturbance = {
        .estimate = true, .model = model, .prior_n = Vector3d::Constant(prior), .slope = 1e-8, .curvature = 1e-10};
    return run(perfect_scenario(anomaly, 300.0), beliefs);
}

TEST(Survey, PerfectInstrumentsShowTheDisturbance) {
    // 10 mGal down and a tilt's worth of horizontal one.
    const sim::AnomalyPart constant{sim::AnomalyPart::Kind::Constant, {3e-5, -4e-5, 1e-4}};
    const Flown r = perfectly_flown(constant, {}, 1e-4);
    EXPECT_LT((r.result.forward.back().disturbance_n - constant.size_n).norm(), 1e-7);
    EXPECT_LT((r.result.smoothed.front().disturbance_n - constant.size_n).norm(), 1e-7);
}

TEST(Survey, APolynomialOfItsDegreeFollowsTheDisturbance) {
    // The crest of a wave of 300 km: over 3 km a parabola of 2 mGal, to a thousandth of that.
    const sim::AnomalyPart crest{sim::AnomalyPart::Kind::Harmonic, {0.0, 0.0, 1e-2}, -75e3, 300e3};
    const auto error = [&](filter::DisturbanceKind kind) {
        const Flown r = perfectly_flown(crest, {kind, 5000.0, Vector3d::Zero()}, 1e-2);
        double worst = 0.0;
        for (std::size_t i = 0; i < r.result.smoothed.size(); ++i)
            worst = std::max(worst, std::abs(r.result.smoothed[i].disturbance_n.z() - r.truth(i).z()));
        return worst;
    };
    EXPECT_LT(error(filter::DisturbanceKind::QuadraticAndFirstOrder), 0.02 * units::mgal);
    EXPECT_GT(error(filter::DisturbanceKind::RampAndFirstOrder), 0.2 * units::mgal);
}

/// The paper's car with 10 mGal on every axis, in one of the loops.
Flown looped(estim::Loop loop, double duration, double period = 600.0) {
    Beliefs beliefs = papers_beliefs();
    beliefs.settings.loop = loop;
    beliefs.settings.feedback_period = period;
    sim::Scenario scenario = papers_scenario(sim::GreatCirclePath{start, 45.0 * units::deg, std::sqrt(2.0)}, duration, 3);
    scenario.anomaly = {sim::AnomalyPart{sim::AnomalyPart::Kind::Constant, {1e-4, 1e-4, -1e-4}}};
    return run(scenario, beliefs);
}

TEST(Survey, LoopsAgreeWhileTheErrorsAreSmall) {
    // A quarter of an hour. Uncorrected, the start's 10 m and the disturbance take the height off by some fifty metres: linear
    // enough. An azimuth that is off by its prior of 1e-3 rad shows the terms of second order first, in a tenth of its sigma.
    const Flown closed = looped(estim::Loop::Closed, 900.0);
    for (const auto& [loop, period] : {std::pair{estim::Loop::Open, 0.0}, std::pair{estim::Loop::Mixed, 200.0}}) {
        const Flown other = looped(loop, 900.0, period);
        ASSERT_EQ(other.result.forward.size(), closed.result.forward.size());
        for (const std::size_t i : {100U, 300U, 899U}) {
            for (const auto part : {&SurveyResult::forward, &SurveyResult::smoothed}) {
                const SurveyEpoch &a = (closed.result.*part)[i], &b = (other.result.*part)[i];
                const Vector3d d = (a.disturbance_n - b.disturbance_n).cwiseAbs(), s = a.sigma_disturbance_n;
                EXPECT_LT(d.z(), 0.01 * units::mgal) << i;
                EXPECT_LT(d.head<2>().norm(), 0.02 * s.head<2>().norm()) << i;
                EXPECT_LT((s - b.sigma_disturbance_n).norm(), 1e-3 * s.norm()) << i;
                EXPECT_LT((a.nav.position.r - b.nav.position.r).norm(), 0.02 * a.sigma_position_n.norm()) << i;
                EXPECT_LT(a.nav.q_eb.angularDistance(b.nav.q_eb), 0.1 * a.sigma_attitude_n.norm()) << i;
                EXPECT_LT((a.f_n - b.f_n).norm(), 3e-6) << i;
            }
        }
    }
}

TEST(SurveySlow, TheOpenLoopOutrunsItsLinearModel) {
    // The height's error grows by cosh(1.76e-3 t), to a hundred kilometres after an hour and a half, and the gradient of gravity
    // is not that of the start any more: fixes are refused and the covariance is opened, again and again, which keeps the estimate
    // alive. A correction every ten minutes keeps it linear.
    const Flown closed = looped(estim::Loop::Closed, 5400.0), mixed = looped(estim::Loop::Mixed, 5400.0),
                open = looped(estim::Loop::Open, 5400.0);
    const auto apart = [&](const Flown& other, std::size_t i) {
        return std::abs(other.result.forward[i].disturbance_n.z() - closed.result.forward[i].disturbance_n.z());
    };
    EXPECT_LT(apart(open, 1500), 0.02 * units::mgal);
    EXPECT_LT(apart(mixed, 5399), 0.002 * units::mgal);
    const auto refused = [](const Flown& flown) {
        return std::ranges::count_if(flown.result.measurements,
                                     [](const auto& r) { return r.status != filter::MeasurementStatus::Accepted; });
    };
    EXPECT_LE(refused(closed), 4);  // of 10800, with a probability of 1e-4
    EXPECT_LE(refused(mixed), 4);
    EXPECT_GT(refused(open), 100);
}

TEST(Survey, TheUncorrectedMechanizationDivergesAsItsVerticalChannel) {
    // d'' = k^2 d - a for a height that is off by d: k^2 is the gradient of gravity, a the disturbance (up), not corrected for.
    Beliefs beliefs = papers_beliefs();
    beliefs.settings.loop = estim::Loop::Open;
    sim::Scenario scenario = papers_scenario(sim::StaticPath{start, Vector3d::Zero()}, 1800.0, 1);
    scenario.imu.errors = {};
    const double up = 1e-4, begin = 10.0;
    scenario.anomaly = {sim::AnomalyPart{sim::AnomalyPart::Kind::Constant, {0.0, 0.0, -up}}};
    const sim::SimulatedData data = sim::simulate(scenario);
    const ReferenceSample& first = data.recording.reference.front();
    const Geodetic right = first.position;
    NavState off{first.time, right, Vector3d::Zero(), math::quaternion_from_rpy(Vector3d::Zero())};
    off.position.h += begin;
    const Prepared survey(scenario, data, beliefs, off);
    filter::PassObserver<test::Frame> nobody;
    const auto filter = survey.end(nobody);
    const filter::InertialModel model = survey.model();
    const earth::Earth& earth = scenario.earth;
    const auto height = [&](const NavStateEcef& s) { return earth::geodetic_from_ecef(earth.ellipsoid, s.position).h - right.h; };
    const auto gravity = [&](double h) { return earth::gravity_down(earth.gravity, right.lat, h); };
    const double gradient = (gravity(right.h - 50.0) - gravity(right.h + 50.0)) / 100.0;
    const double k = std::sqrt(gradient), rest = up / gradient;
    const double expected = rest + (begin - rest) * std::cosh(k * 1800.0);
    EXPECT_NEAR(height(filter.nav), expected, 0.01 * std::abs(expected));
    EXPECT_LT(std::abs(height(filter.estimated(model))), 0.2);
    EXPECT_NEAR(-filter::disturbance_of(model.layout, filter.estimated_parameters()).z(), up, 0.1 * units::mgal);
}

TEST(Survey, AnOpenLoopCountsWithWhatItKnowsOfItsReference) {
    // The reference keeps a wrong velocity and the sensors' biases. The disturbance's pace, the lever arm's velocity and the
    // specific force are the vehicle's.
    Beliefs beliefs = perfect_beliefs();
    beliefs.settings.loop = estim::Loop::Open;
    beliefs.disturbance = {
        true, false, {filter::DisturbanceKind::RampAndFirstOrder, 5000.0, Vector3d::Zero()}, Vector3d::Constant(1e-9), 1e-6};
    beliefs.velocity = 2.0;
    beliefs.accel_bias = 1e-3;
    beliefs.gyro_bias = 2e-5;
    beliefs.settings.imu.errors.accel_turn_on_bias = beliefs.settings.imu.errors.gyro_turn_on_bias =
        1e-9;  // constant, not forgotten
    beliefs.settings.gnss.lever_arm_b = {0.0, 30.0, 0.0};
    const double by_metre = 2e-7, gyro_x = 2e-5, accel_x = 1e-3;
    sim::Scenario scenario = perfect_scenario({sim::AnomalyPart::Kind::Ramp, {0.0, 0.0, 1e3 * by_metre}, 0.0, 1e3}, 20.0);
    scenario.gnss.lever_arm_b = beliefs.settings.gnss.lever_arm_b;
    scenario.imu.rate = 50.0;
    sim::SimulatedData data = sim::simulate(scenario);
    for (ImuSample& s : data.recording.imu) {
        s.gyro.x() += gyro_x / scenario.imu.rate;  // as if the antenna, out to the right, went down
        s.accel.x() += accel_x / scenario.imu.rate;
    }
    const Prepared survey(scenario, data, beliefs, erring_start(scenario, data, beliefs));
    filter::PassObserver<test::Frame> nobody;
    const auto filter = survey.end(nobody);
    const filter::InertialModel model = survey.model();
    EXPECT_NEAR(filter.estimated_parameters()(model.layout.gravity_slope + 2), by_metre, 0.05 * by_metre);
    const ReferenceSample& end = data.recording.reference.back();
    const earth::EarthTerms terms = earth::terms_at(scenario.earth, end.position, end.velocity_n);
    const Vector3d down(0.0, 0.0, earth::gravity_down(scenario.earth.gravity, end.position.lat, end.position.h));
    const Vector3d f_n = (2.0 * terms.w_ie_n + terms.w_en_n).cross(end.velocity_n) - down;
    EXPECT_NEAR(filter.geographic(model).v_eb_n.z(), 0.0, 0.1 * gyro_x * scenario.gnss.lever_arm_b.y());
    EXPECT_LT((survey.run({.smooth = false}).forward.back().f_n - f_n).norm(), 0.1 * accel_x);
}

TEST(Survey, StretchesOfTheSmootherAreThoseOfTheWhole) {
    Beliefs beliefs = papers_beliefs();
    beliefs.settings.loop = estim::Loop::Mixed;  // what is kept beside the reference must survive a checkpoint
    beliefs.settings.feedback_period = 60.0;
    sim::Scenario scenario = papers_scenario(sim::GreatCirclePath{start, 0.5, 10.0}, 200.0, 2);
    scenario.imu.rate = 1.0;  // a fix at every increment: none is lost or taken twice where stretches meet
    const sim::SimulatedData data = sim::simulate(scenario);
    const Prepared survey(scenario, data, beliefs, erring_start(scenario, data, beliefs));
    const SurveyResult whole = survey.run(), parts = survey.run({.stretch = 37});
    ASSERT_EQ(whole.smoothed.size(), 200U);
    ASSERT_EQ(parts.smoothed.size(), whole.smoothed.size());
    for (std::size_t i = 0; i < whole.smoothed.size(); ++i) {
        EXPECT_EQ(parts.smoothed[i].disturbance_n, whole.smoothed[i].disturbance_n) << i;
        EXPECT_EQ(parts.smoothed[i].sigma_disturbance_n, whole.smoothed[i].sigma_disturbance_n) << i;
        EXPECT_EQ(parts.smoothed[i].nav.position.r, whole.smoothed[i].nav.position.r) << i;
    }
}

TEST(Survey, AStepIsLookedForWhereItIsAnnounced) {
    const sim::AnomalyPart step{sim::AnomalyPart::Kind::Step, {0.0, 0.0, 5e-5}, 300.0, 1.0, true};
    sim::Scenario scenario = papers_scenario(sim::StaticPath{start, Vector3d::Zero()}, 600.0, 4);
    scenario.anomaly = {step};
    const sim::SimulatedData data = sim::simulate(scenario);
    const Beliefs beliefs = papers_beliefs();
    const Prepared survey(scenario, data, beliefs, erring_start(scenario, data, beliefs));
    const Time at = data.recording.reference.front().time + Duration::from_seconds(300.0);
    const SurveyResult told = survey.run({.steps = {at}}), untold = survey.run();
    const auto after = std::ranges::find_if(told.forward, [&](const SurveyEpoch& e) { return e.time > at; });
    ASSERT_NE(after, told.forward.end());
    EXPECT_GT(after->sigma_disturbance_n.z(), 5.0 * (after - 2)->sigma_disturbance_n.z());
    for (const auto& [epochs, i] : {std::pair{&told.forward, told.forward.size() - 1},
                                    std::pair{&told.smoothed, std::size_t{100}}, std::pair{&told.smoothed, std::size_t{500}}}) {
        const SurveyEpoch& e = (*epochs)[i];
        const double truth = e.time > at ? step.size_n.z() : 0.0;
        EXPECT_LT(std::abs(e.disturbance_n.z() - truth), 4.0 * e.sigma_disturbance_n.z()) << i;
        EXPECT_LT(e.sigma_disturbance_n.z(), 5e-6) << i;
    }
    EXPECT_GT(std::abs(untold.smoothed[100].disturbance_n.z()), 4.0 * untold.smoothed[100].sigma_disturbance_n.z());
}

// The disturbance before the step is a state: what both sides have in common cancels in the sigma of the change.
TEST(Survey, TheSigmaOfAChangeIsThatOfTheDifference) {
    const sim::AnomalyPart step{sim::AnomalyPart::Kind::Step, {2e-4, -1e-4, 5e-5}, 300.0, 1.0, true};
    Beliefs beliefs = papers_beliefs();
    beliefs.disturbance.keep_before = true;
    beliefs.disturbance.prior_n.setConstant(2e-4);
    Vector3d nees = Vector3d::Zero(), ratio = Vector3d::Zero();
    constexpr int seeds = 24;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        sim::Scenario scenario = papers_scenario(sim::StaticPath{start, Vector3d::Zero()}, 600.0, seed);
        scenario.anomaly = {step};
        const sim::SimulatedData data = sim::simulate(scenario);
        const Prepared survey(scenario, data, beliefs, erring_start(scenario, data, beliefs));
        const Time at = data.recording.reference.front().time + Duration::from_seconds(300.0);
        const SurveyResult r = survey.run({.smooth = false, .steps = {at}});
        const SurveyEpoch& last = r.forward.back();
        nees += (last.change_n - step.size_n).cwiseQuotient(last.sigma_change_n).cwiseAbs2() / seeds;
        const auto before = std::ranges::find_if(r.forward, [&](const SurveyEpoch& e) { return e.time >= at; }) - 1;
        ratio += last.sigma_change_n.cwiseQuotient(
                     (last.sigma_disturbance_n.cwiseAbs2() + before->sigma_disturbance_n.cwiseAbs2()).cwiseSqrt()) /
                 seeds;
    }
    for (int k = 0; k < 3; ++k) {
        EXPECT_GT(nees(k), 0.4) << k;  // chi-square of 24, 99.8 %
        EXPECT_LT(nees(k), 2.0) << k;
        EXPECT_LT(ratio(k), 0.5) << k;  // the sum of both variances
    }
}

TEST(Survey, ABlunderIsRefusedAndAnOutageBridged) {
    // A fix that is off by 30 m, and a minute in which none is taken: as everywhere in the one filter.
    sim::Scenario scenario = papers_scenario(sim::GreatCirclePath{start, 0.5, 10.0}, 600.0, 6);
    sim::SimulatedData data = sim::simulate(scenario);
    Beliefs beliefs = papers_beliefs();
    const NavState begin = erring_start(scenario, data, beliefs);
    const SurveyResult clean = Prepared(scenario, data, beliefs, begin).run();
    data.recording.gnss[400].position.h += 30.0;
    beliefs.settings.outages = {{200.0, 60.0}};
    const SurveyResult found = Prepared(scenario, data, beliefs, begin).run();
    EXPECT_EQ(found.forward.size() + 59, clean.forward.size());
    EXPECT_EQ(found.smoothed.size(), found.forward.size());
    const auto blunder = std::ranges::find(found.forward, std::size_t{400}, &SurveyEpoch::fix);
    ASSERT_NE(blunder, found.forward.end());
    EXPECT_EQ(blunder->measured, 3);  // the velocity of it
    const SurveyEpoch &a = clean.forward.back(), &b = found.forward.back();
    EXPECT_LT(std::abs(a.disturbance_n.z() - b.disturbance_n.z()), a.sigma_disturbance_n.z());
}

TEST(Survey, FixesOfAnotherTimeAreRefused) {
    const sim::Scenario scenario = papers_scenario(sim::GreatCirclePath{start, 0.5, 10.0}, 10.0, 1);
    sim::SimulatedData data = sim::simulate(scenario);
    const Beliefs beliefs = papers_beliefs();
    const NavState begin = erring_start(scenario, data, beliefs);
    for (GnssFix& fix : data.recording.gnss) fix.time = fix.time + Duration::from_seconds(100.0);
    EXPECT_THROW((void)Prepared(scenario, data, beliefs, begin).run(), Error);
}

}  // namespace
}  // namespace schuler::gravimetry
