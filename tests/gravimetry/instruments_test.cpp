// Log of velocity, gauges and compass: simulated with their errors, taken by the filter, which finds those errors.
#include "gravimetry/prepared_survey.h"

#include "schuler/core/units.h"
#include "schuler/sim/instruments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::gravimetry {
namespace {

using Eigen::Vector3d;
using test::Beliefs;
using test::Frame;
using test::Prepared;

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
Beliefs believed() {
    Beliefs b;
    b.settings.imu.errors.gyro_noise = 1e-6;
    b.settings.imu.errors.accel_noise = 1e-5;
    b.settings.gnss.use_velocity = false;
    b.attitude_n = {2e-4, 2e-4, 0.03};
    b.velocity = 0.05;
    b.position = 1.0;
    b.gyro_bias = 1e-8;
    b.disturbance.prior_n.setConstant(1e-6);
    return b;
}

/// The filter after the voyage, and the truth of the end.
struct End {
    filter::InertialModel model;
    filter::InertialFilter<Frame> filter;
    ReferenceSample truth;
    double nis = 0.0;
    int measured = 0;

    [[nodiscard]] double value(int state) const { return filter.parameters(state); }
    [[nodiscard]] double sigma(int state) const { return std::sqrt(filter.P(state, state)); }
    [[nodiscard]] filter::Matrix9 P_n() const { return filter.local_covariance(model); }
};
struct Innovations : filter::PassObserver<Frame> {
    void measurement(const filter::MeasurementRecord& record) override {
        nis += record.nis;
        measured += record.dof;
    }
    double nis = 0.0;
    int measured = 0;
};
End sail(const sim::Scenario& scenario, const Beliefs& beliefs, const InstrumentLogs& instruments,
         const sim::SimulatedData& data) {
    const ReferenceSample& first = data.recording.reference.front();
    const NavState start{first.time, first.position, first.velocity_n,
                         math::quaternion_from_rpy(first.rpy + Vector3d(1e-4, -1e-4, 0.02))};
    const Prepared survey(scenario, data, beliefs, start, instruments);
    Innovations seen;
    const auto filter = survey.end(seen);
    return {survey.model(), filter, data.recording.reference.back(), seen.nis, seen.measured};
}
End sail(const sim::Scenario& scenario, const Beliefs& beliefs, const InstrumentLogs& instruments) {
    return sail(scenario, beliefs, instruments, sim::simulate(scenario));
}

sim::InstrumentErrors ones() {
    sim::InstrumentErrors e;
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
InstrumentLogs sampled(const sim::InstrumentErrors& errors, const sim::Scenario& s) {
    return sim::simulate_instruments(errors, s.earth, *sim::make_path(s.path, s.earth.ellipsoid), s.duration, s.origin, s.seed);
}

void expect_consistent(const End& end) {
    EXPECT_GT(end.nis / end.measured, 0.85);  // 1500 and more degrees of freedom: four sigma is 0.15
    EXPECT_LT(end.nis / end.measured, 1.15);
}

TEST(SurveyInstruments, TheLogsScaleAndMisalignmentAreFound) {
    const sim::Scenario scenario = voyage(3);
    Beliefs beliefs = believed();
    const sim::InstrumentErrors errors = ones();
    beliefs.settings.log = {
        .std = errors.log.white, .scale_std = 0.01, .misalignment_std = 0.01, .lever_arm_b = errors.log.lever_arm_b};
    const End end = sail(scenario, beliefs, {{}, sampled(errors, scenario).velocities, {}});
    // The truth from samples without noise: what the log makes of a steady speed straight ahead.
    sim::InstrumentErrors bare = errors;
    bare.log.white = 0.0;
    bare.log.lever_arm_b.setZero();
    sim::Scenario calm = scenario;
    calm.path = sim::GreatCirclePath{{0.9, 0.4, 20.0}, 0.8, 6.0};
    const Vector3d shown = sampled(bare, calm).velocities.front().velocity_b / 6.0;
    const Vector3d truth(shown.x() - 1.0, -shown.z() / shown.x(), shown.y() / shown.x());  // scale, about right, about down
    for (int i = 0; i < 3; ++i) {
        const int state = end.model.layout.log_scale + i;  // the misalignments follow
        EXPECT_LT(std::abs(end.value(state) - truth(i)), 3.5 * end.sigma(state)) << i;
        EXPECT_LT(end.sigma(state), 0.2 * 0.01) << i << ": found, not left alone";
    }
    expect_consistent(end);
}

TEST(SurveyInstruments, GaugesTellAttitudeAndTheirOwnErrors) {
    const sim::Scenario scenario = voyage(4);
    Beliefs beliefs = believed();
    beliefs.attitude_n.head<2>().setConstant(0.01);  // coarser than the start is wrong: the gauges must not make it worse
    sim::InstrumentErrors errors = ones();
    filter::GaugeSettings& gauges = beliefs.settings.gauges;
    gauges.std = errors.gauges.white;
    for (std::size_t i = 0; i < 3; ++i) gauges.lever_arms_b[i] = errors.gauges.lever_arms_b[i];
    // Exact levels: two millimetres of noise over lever arms of tens of metres, at once.
    gauges.level_std = 0.0;
    sim::Scenario brief = scenario;
    brief.duration = 1.0;
    const End at_once = sail(brief, beliefs, {sampled(errors, scenario).gauges, {}, {}});
    EXPECT_LT(std::sqrt(at_once.P_n().diagonal().segment<2>(filter::Layout::attitude).maxCoeff()), 6e-4);
    // Unknown ones: found against the fixes.
    errors.gauges.bias = gauges.level_std = 0.5;
    const End end = sail(scenario, beliefs, {sampled(errors, scenario).gauges, {}, {}});
    sim::InstrumentErrors bare = errors;
    bare.gauges.white = 0.0;
    sim::InstrumentErrors right = bare;
    right.gauges.bias = 0.0;
    const Vector3d truth = sampled(bare, scenario).gauges.front().height - sampled(right, scenario).gauges.front().height;
    for (int i = 0; i < 3; ++i) {
        const int state = end.model.layout.gauge_level + i;
        EXPECT_LT(std::abs(end.value(state) - truth(i)), 3.5 * end.sigma(state)) << i;
        EXPECT_LT(end.sigma(state), 0.1) << i;
    }
    const Vector3d rpy = math::rpy_from_quaternion(end.filter.geographic(end.model).q_nb);
    EXPECT_LT((rpy - end.truth.rpy).head<2>().norm(), 1e-3);
    expect_consistent(end);
}

TEST(SurveyInstruments, AHeightThatIsOlderThanItsFixCountsWhereItWasTrue) {
    // The receiver's heights lag by 0.4 s, its horizontal positions do not; the ship heaves.
    sim::Scenario scenario = voyage(6);
    scenario.reference_rate = 10.0;
    sim::SimulatedData data = sim::simulate(scenario);
    math::Random random(6, "late heights");
    for (std::size_t i = 1; i < data.recording.gnss.size(); ++i)
        data.recording.gnss[i].position.h = data.recording.reference[10 * i - 4].position.h + 0.1 * random.normal();
    Beliefs beliefs = believed();
    const End taken_as_it_is = sail(scenario, beliefs, {}, data);
    EXPECT_GT(taken_as_it_is.nis / taken_as_it_is.measured, 1.5);
    beliefs.settings.gnss.height_latency = 0.4;
    expect_consistent(sail(scenario, beliefs, {}, data));
}

TEST(SurveyInstruments, TheCompassTellsHeadingToItsDeviation) {
    const sim::Scenario scenario = voyage(5);
    Beliefs beliefs = believed();
    beliefs.gyro_bias = 1e-4;  // gyros that cannot find north themselves
    const sim::InstrumentErrors errors = ones();
    beliefs.settings.heading = {.std = errors.compass.white, .offset_std = errors.compass.bias};
    const End end = sail(scenario, beliefs, {{}, {}, sampled(errors, scenario).headings});
    const double sigma = std::sqrt(end.P_n()(filter::Layout::attitude + 2, filter::Layout::attitude + 2));
    EXPECT_LT(sigma, 1.05 * errors.compass.bias);
    EXPECT_GT(sigma, 0.5 * errors.compass.bias);  // never better than its constant error, but for what the start knew
    const double heading = math::rpy_from_quaternion(end.filter.geographic(end.model).q_nb).z();
    EXPECT_LT(std::abs(math::wrap_pi(heading - end.truth.rpy.z())), 3.0 * sigma);
    expect_consistent(end);
}

}  // namespace
}  // namespace schuler::gravimetry
