// The whole survey: simulated instruments over a disturbance, filter and smoother, against the truth and against their own sigmas.
#include "schuler/gravimetry/survey_run.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/gravimetry/attainable.h"
#include "schuler/ins/step.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/survey.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace schuler::gravimetry {
namespace {

using Eigen::Vector3d;

constexpr double gyro = 0.01 * units::deg_per_hour;
const Geodetic start{55.8114694 * units::deg, 37.4998612 * units::deg, 164.15};

/// Paper E's instruments with a carrier-phase receiver, and a filter that believes what is simulated.
sim::SurveyInstruments papers_instruments() {
    sim::SurveyInstruments in;
    in.gyro_bias = in.gyro_noise = gyro;
    in.accel_bias = in.accel_noise = 1e-6;
    in.gnss_position_bias = in.gnss_position_noise = 0.05;
    in.gnss_velocity_bias = in.gnss_velocity_noise = 0.05;
    return in;
}
SurveySettings papers_settings(const sim::SurveyInstruments& in) {
    SurveySettings s;
    s.noise = {gyro * gyro / in.imu_rate, 1e-12 / in.imu_rate};
    s.prior.attitude_n = {1e-4, 1e-4, 1e-3};
    s.prior.gyro_bias = gyro;
    return s;
}

SurveyInput input_of(const sim::SimulatedSurvey& data, const sim::TruthPath& path, const SurveySettings& settings,
                     const sim::SurveyInstruments& in, std::uint64_t seed) {
    SurveyInput input;
    input.imu = data.imu;
    for (const sim::EcefFix& fix : data.fixes)
        input.fixes.push_back({fix.time, fix.position, fix.velocity, Vector3d::Constant(in.gnss_position_noise),
                               Vector3d::Constant(in.gnss_velocity_noise)});
    math::Random random(seed, "start errors");
    NavState right = sim::nav_state(path.at(0.0), Time{});
    const Vector3d tilt = settings.prior.attitude_n.cwiseProduct(random.normal3());
    right.q_nb = math::quaternion_from_rotation_vector(tilt) * right.q_nb;
    input.start = ins::to_ecef(settings.earth, right);
    input.start.position.r += settings.prior.position * random.normal3();
    input.start.v_eb_e += settings.prior.velocity * random.normal3();
    return input;
}

struct Flown {
    sim::SimulatedSurvey data;
    SurveyResult result;
};
Flown run(const sim::PathSettings& path_settings, const std::vector<sim::AnomalyPart>& parts, const SurveySettings& settings,
        const sim::SurveyInstruments& in, double duration, std::uint64_t seed) {
    const auto path = sim::make_path(path_settings, settings.earth.ellipsoid);
    const sim::AnomalyTrack anomaly(parts, sim::distance_along(*path, duration), duration, seed);
    Flown out{sim::simulate_survey(settings.earth, *path, anomaly, in, duration, seed), {}};
    out.result = run_survey(settings, input_of(out.data, *path, settings, in, seed), true);
    return out;
}

double median(std::vector<double> x) {
    std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
    return x[x.size() / 2];
}

TEST(SurveySlow, ConstantDisturbanceOfThePapersScenario) {
    // Half an hour of the car. The disturbance is drawn from its prior; its level cannot be better than the accelerometer's error.
    const sim::SurveyInstruments in = papers_instruments();
    const SurveySettings settings = papers_settings(in);
    const sim::GreatCirclePath path{start, 45.0 * units::deg, std::sqrt(2.0)};
    std::vector<double> errors;
    double nees = 0.0, nees_smoothed = 0.0;
    const int seeds = 48;
    for (int seed = 1; seed <= seeds; ++seed) {
        math::Random random(static_cast<std::uint64_t>(seed), "disturbance");
        const sim::AnomalyPart constant{sim::AnomalyPart::Kind::Constant, 1e-4 * random.normal3()};
        const Flown r = run(path, {constant}, settings, in, 1800.0, static_cast<std::uint64_t>(seed));
        const SurveyEpoch& last = r.result.forward.back();
        const SurveyEpoch& middle = r.result.smoothed[300];
        const double error = last.disturbance_n.z() - r.data.truth.back().disturbance_n.z();
        const double smoothed_error = middle.disturbance_n.z() - r.data.truth[300].disturbance_n.z();
        errors.push_back(std::abs(error));
        nees += std::pow(error / last.sigma_disturbance_n.z(), 2) / seeds;
        nees_smoothed += std::pow(smoothed_error / middle.sigma_disturbance_n.z(), 2) / seeds;
        EXPECT_LT(middle.sigma_disturbance_n.z(), 1.02e-6);   // the whole hour's knowledge, ten minutes in
        EXPECT_LT(last.sigma_attitude_n.x(), 2.2 * units::arcsec);
    }
    EXPECT_LT(median(errors), 0.1 * units::mgal);
    EXPECT_GT(nees, 0.55);            // chi-square of 48, 99 %
    EXPECT_LT(nees, 1.60);
    EXPECT_GT(nees_smoothed, 0.55);
    EXPECT_LT(nees_smoothed, 1.60);
    RecordProperty("median_mgal", std::to_string(median(errors) / units::mgal));
    RecordProperty("nees", std::to_string(nees));
    RecordProperty("nees_smoothed", std::to_string(nees_smoothed));
}

TEST(SurveySlow, AnomalyThatChangesAlongTheTrack) {
    // 60 m/s over a second-order process of 5 km: filter and smoother stay within their sigmas, and the smoother is the better.
    sim::SurveyInstruments in = papers_instruments();
    SurveySettings settings = papers_settings(in);
    settings.prior.disturbance_n.setConstant(1e-5);
    settings.disturbance = {DisturbanceKind::SecondOrder, 5000.0, Vector3d::Constant(3e-4), false};
    const sim::AnomalyPart field{sim::AnomalyPart::Kind::GaussMarkov2, Vector3d::Constant(3e-4), 0.0, 5000.0};
    double forward = 0.0, smoothed = 0.0, nees = 0.0, nees_smoothed = 0.0;
    int count = 0;
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
        const Flown r = run(sim::GreatCirclePath{start, 0.5, 60.0}, {field}, settings, in, 1200.0, seed);
        for (std::size_t i = 200; i < 1000; i += 40, ++count) {
            const double truth = r.data.truth[i].disturbance_n.z();
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

TEST(Survey, PerfectInstrumentsShowTheDisturbance) {
    // No noise, no errors: what is left is the discretisation. 10 mGal down and a tilt's worth of horizontal one.
    sim::SurveyInstruments in;
    SurveySettings settings = papers_settings(in);
    settings.prior.attitude_n.setConstant(1e-9);
    settings.prior.position = 1e-3;
    settings.prior.velocity = 1e-4;
    settings.prior.accel_bias = settings.prior.gyro_bias = 0.0;
    settings.prior.gnss_position = settings.prior.gnss_velocity = 0.0;
    settings.noise = {1e-22, 1e-16};
    in.gnss_position_noise = 1e-3;
    const sim::AnomalyPart constant{sim::AnomalyPart::Kind::Constant, {3e-5, -4e-5, 1e-4}};
    const Flown r = run(sim::GreatCirclePath{start, 0.5, 10.0}, {constant}, settings, in, 300.0, 1);
    EXPECT_LT((r.result.forward.back().disturbance_n - constant.size_n).norm(), 1e-7);
    EXPECT_LT((r.result.smoothed.front().disturbance_n - constant.size_n).norm(), 1e-7);
}

TEST(Survey, LogsThatDoNotFitAreRefused) {
    const sim::SurveyInstruments in = papers_instruments();
    const SurveySettings settings = papers_settings(in);
    const auto path = sim::make_path(sim::GreatCirclePath{start, 0.5, 10.0}, settings.earth.ellipsoid);
    const sim::SimulatedSurvey data = sim::simulate_survey(settings.earth, *path, {{}, 100.0, 10.0, 1}, in, 10.0, 1);
    SurveyInput input = input_of(data, *path, settings, in, 1);
    input.imu.erase(input.imu.begin() + 5);
    EXPECT_THROW((void)run_survey(settings, input, false), Error);
    input = input_of(data, *path, settings, in, 1);
    input.fixes.clear();
    EXPECT_THROW((void)run_survey(settings, input, false), Error);
}

}  // namespace
}  // namespace schuler::gravimetry
