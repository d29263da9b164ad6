// Log of velocity, gauges and compass: simulated with their errors, taken by the filter, which finds those errors.
#include "schuler/sim/aids.h"
#include "schuler/core/units.h"
#include "schuler/gravimetry/survey_filter.h"
#include "schuler/gravimetry/survey_run.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/simulate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::gravimetry {
namespace {

using Eigen::Vector3d;

/// A ship of 6 m/s in waves for five minutes, good inertial sensors, metre fixes without velocity.
sim::Scenario voyage(std::uint64_t seed) {
    sim::Scenario s;
    s.seed = seed;
    s.duration = 300.0;
    s.path = sim::ShipPath{{0.9, 0.4, 20.0}, 0.8, 6.0};
    s.reference_rate = 1.0;
    s.imu.rate = 20.0;
    s.imu.errors.gyro_noise = 1e-6;
    s.imu.errors.accel_noise = 1e-5;
    s.gnss.white_position.setConstant(0.1);
    return s;
}
SurveySettings believed() {
    SurveySettings s;
    s.noise = {1e-12, 1e-10};
    s.prior.attitude_n = {2e-4, 2e-4, 0.03};
    s.prior.velocity = 0.05;
    s.prior.position = 1.0;
    s.prior.gnss_position_n.setConstant(1e-3);
    s.prior.gnss_velocity = 1e-3;
    s.prior.gyro_bias = 1e-8;
    s.prior.disturbance_n.setConstant(1e-6);
    return s;
}

/// The filter after the voyage, what it was told at every second from `told`, and the truth of the end.
struct End {
    SurveyState state;
    StateMatrix P;
    ReferenceSample truth;
    double nis = 0.0;
    int measured = 0;
};
template <class Sample, class Fix>
End sail(const sim::Scenario& scenario, const SurveySettings& settings, const std::vector<Sample>& samples, Fix fix_of) {
    const sim::SimulatedData data = sim::simulate(scenario);
    const ReferenceSample& first = data.recording.reference.front();
    NavState start{first.time, first.position, first.velocity_n,
                   math::quaternion_from_rpy(first.rpy + Vector3d(1e-4, -1e-4, 0.02))};
    SurveyFilter filter(settings, ins::to_ecef(settings.earth, start));
    End end;
    std::size_t next = 1;   // of both: the first ones are of the start
    for (const ImuSample& s : data.recording.imu) {
        filter.advance({s.time, 1.0 / scenario.imu.rate, s.gyro, s.accel});
        if (next >= samples.size() || std::abs((samples[next].time - s.time).seconds()) > 1e-6) continue;
        const auto take = [&](const FixStep& step) {
            end.nis += step.nis();
            end.measured += static_cast<int>(step.used);
        };
        for (const auto& fix : fix_of(samples[next])) take(filter.take(fix));
        const GnssFix& g = data.recording.gnss[next];
        take(filter.take(AntennaFix{g.time, earth::ecef_from_geodetic(settings.earth.ellipsoid, g.position).r, Vector3d::Zero(),
                                    scenario.gnss.white_position, Vector3d::Constant(std::numeric_limits<double>::infinity())}));
        ++next;
    }
    end.state = filter.estimate();
    end.P = filter.P();
    end.truth = data.recording.reference.back();
    return end;
}

sim::AidErrors ones() {
    sim::AidErrors e;
    e.gauges.rate = e.log.rate = e.compass.rate = 1.0;
    e.gauges.white = 0.002;
    e.gauges.lever_arms_b = {{0.0, 0.0, 1.0}, {40.0, 0.0, 2.0}, {-10.0, 8.0, 2.0}};
    e.log.white = 0.02;
    e.log.scale = 0.01;
    e.log.misalignment = 0.01;
    e.log.lever_arm_b = {12.0, -1.0, 3.0};
    e.compass.white = 0.02;
    e.compass.bias = 0.01;
    return e;
}
AidLog sampled(const sim::AidErrors& errors, const sim::Scenario& s) {
    return sim::simulate_aids(errors, s.earth, *sim::make_path(s.path, s.earth.ellipsoid), s.duration, s.origin, s.seed);
}

void expect_consistent(const End& end) {
    EXPECT_GT(end.nis / end.measured, 0.85);   // 1500 and more degrees of freedom: four sigma is 0.15
    EXPECT_LT(end.nis / end.measured, 1.15);
}

TEST(SurveyAids, TheLogsScaleAndMisalignmentAreFound) {
    const sim::Scenario scenario = voyage(3);
    SurveySettings settings = believed();
    const sim::AidErrors errors = ones();
    settings.log_lever_arm_b = errors.log.lever_arm_b;
    settings.prior.log_scale = settings.prior.log_misalignment = 0.01;
    const End end = sail(scenario, settings, sampled(errors, scenario).velocities, [&](const BodyVelocitySample& s) {
        return std::vector{BodyVelocityFix{s.time, s.velocity_b, Vector3d::Constant(errors.log.white)}};
    });
    // The truth from samples without noise: what the log makes of a steady speed straight ahead.
    sim::AidErrors bare = errors;
    bare.log.white = 0.0;
    bare.log.lever_arm_b.setZero();
    sim::Scenario calm = scenario;
    calm.path = sim::GreatCirclePath{{0.9, 0.4, 20.0}, 0.8, 6.0};
    const Vector3d shown = sampled(bare, calm).velocities.front().velocity_b / 6.0;
    const Vector3d truth(shown.x() - 1.0, -shown.z() / shown.x(), shown.y() / shown.x());   // scale, about right, about down
    for (int i = 0; i < 3; ++i) {
        const double sigma = std::sqrt(end.P(log_scale + i, log_scale + i)),
                     error = end.state.parameters(log_scale + i) - truth(i);
        EXPECT_LT(std::abs(error), 3.5 * sigma) << i;
        EXPECT_LT(sigma, 0.2 * 0.01) << i << ": found, not left alone";
    }
    expect_consistent(end);
}

TEST(SurveyAids, GaugesTellAttitudeAndTheirOwnErrors) {
    const sim::Scenario scenario = voyage(4);
    SurveySettings settings = believed();
    settings.prior.attitude_n.head<2>().setConstant(0.01);  // coarser than the start is wrong: the gauges must not make it worse
    sim::AidErrors errors = ones();
    for (std::size_t i = 0; i < 3; ++i) settings.gauge_lever_arms_b[i] = errors.gauges.lever_arms_b[i];
    const auto fixes = [&](const GaugeSample& s) {
        std::vector<HeightFix> out;
        for (int i = 0; i < 3; ++i) out.push_back({s.time, s.height(i), errors.gauges.white, i});
        return out;
    };
    // Exact levels: two millimetres of noise over lever arms of tens of metres, at once.
    settings.prior.height_bias = 0.0;
    const auto samples = sampled(errors, scenario).gauges;
    sim::Scenario brief = scenario;
    brief.duration = 1.0;
    const End at_once = sail(brief, settings, samples, fixes);
    const Geodetic place = at_once.truth.position;
    const Eigen::Matrix3d C_en = earth::C_en(place.lat, place.lon);
    const Vector3d variance = (C_en.transpose() * at_once.P.block<3, 3>(attitude, attitude) * C_en).diagonal();
    EXPECT_LT(std::sqrt(variance.head<2>().maxCoeff()), 6e-4);
    // Unknown ones: found against the fixes.
    errors.gauges.bias = settings.prior.height_bias = 0.5;
    const End end = sail(scenario, settings, sampled(errors, scenario).gauges, fixes);
    sim::AidErrors bare = errors;
    bare.gauges.white = 0.0;
    sim::AidErrors right = bare;
    right.gauges.bias = 0.0;
    const Vector3d truth = sampled(bare, scenario).gauges.front().height - sampled(right, scenario).gauges.front().height;
    for (int i = 0; i < 3; ++i) {
        const double sigma = std::sqrt(end.P(height_bias + i, height_bias + i));
        EXPECT_LT(std::abs(end.state.parameters(height_bias + i) - truth(i)), 3.5 * sigma) << i;
        EXPECT_LT(sigma, 0.1) << i;
    }
    const Vector3d rpy = math::rpy_from_quaternion(ins::to_geographic(settings.earth, end.state.nav).q_nb);
    EXPECT_LT((rpy - end.truth.rpy).head<2>().norm(), 1e-3);
    expect_consistent(end);
}

TEST(SurveyAids, TheCompassTellsHeadingToItsDeviation) {
    const sim::Scenario scenario = voyage(5);
    SurveySettings settings = believed();
    settings.prior.gyro_bias = 1e-4;  // gyros that cannot find north themselves
    const sim::AidErrors errors = ones();
    settings.prior.heading_bias = errors.compass.bias;
    const End end = sail(scenario, settings, sampled(errors, scenario).headings, [&](const HeadingSample& s) {
        return std::vector{HeadingFix{s.time, s.heading, errors.compass.white}};
    });
    const NavState nav = ins::to_geographic(settings.earth, end.state.nav);
    const Vector3d down_e = earth::C_en(nav.position.lat, nav.position.lon).col(2);
    const double sigma = std::sqrt(down_e.dot(end.P.block<3, 3>(attitude, attitude) * down_e));
    EXPECT_LT(sigma, 1.05 * errors.compass.bias);
    EXPECT_GT(sigma, 0.5 * errors.compass.bias);  // never better than its constant error, but for what the start knew
    EXPECT_LT(std::abs(math::wrap_pi(math::rpy_from_quaternion(nav.q_nb).z() - end.truth.rpy.z())), 3.0 * sigma);
    expect_consistent(end);
}

}  // namespace
}  // namespace schuler::gravimetry
