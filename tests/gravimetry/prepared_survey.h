// A simulated survey made ready for the filter: increments, events and a start that errs as it is believed to.
#pragma once

#include "schuler/core/instrument_logs.h"
#include "schuler/fusion/timeline.h"
#include "schuler/gravimetry/survey_run.h"
#include "schuler/ins/step.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/simulate.h"

#include <gtest/gtest.h>

#include <vector>

namespace schuler::gravimetry::test {

using Frame = filter::EarthFixedFrame;

/// Instruments, one sigma of the start (attitude north, east, down), and the disturbance.
struct Beliefs {
    filter::Settings settings;
    filter::DisturbanceSettings disturbance;
    Eigen::Vector3d attitude_n = Eigen::Vector3d::Constant(1e-4);  ///< rad
    double velocity = 0.01, position = 10.0;                       ///< m/s, m
    double accel_bias = 1e-6, gyro_bias = 4.8e-8;                  ///< m/s^2, rad/s
};

struct Prepared {
    Recording recording;
    filter::RunData data;
    filter::Settings settings;
    filter::Start start;

    /// The samples of an InstrumentLogs that are to be taken.
    Prepared(const sim::Scenario& scenario, const sim::SimulatedData& simulated, const Beliefs& beliefs, const NavState& nav,
             const InstrumentLogs& instruments = {})
        : settings(gravity27(beliefs.settings, beliefs.disturbance)) {
        recording.gnss = simulated.recording.gnss;
        recording.gauges = instruments.gauges;
        recording.body_velocity = instruments.velocities;
        recording.heading = instruments.headings;
        data.recording = &recording;
        data.origin = nav.time;
        data.imu.median_dt = 1.0 / scenario.imu.rate;
        for (const ImuSample& s : simulated.recording.imu)
            data.imu.increments.push_back({s.time, 1.0 / scenario.imu.rate, s.gyro, s.accel});
        WarningLog unheard;
        data.events = fusion::make_events(recording, settings, data.origin, unheard);
        const auto& g = scenario.gnss;
        data.fix_noise.assign(recording.gnss.size(), {g.white_position, g.white_velocity, g.white_position, g.white_velocity});
        filter::set_limits(data, settings);
        start.nav = nav;
        start.std_position.setConstant(beliefs.position);
        start.std_velocity.setConstant(beliefs.velocity);
        start.std_rpy = beliefs.attitude_n;  // level, or level enough
        start.std_gyro_bias.setConstant(beliefs.gyro_bias);
        start.std_accel_bias.setConstant(beliefs.accel_bias);
    }
    Prepared(const Prepared&) = delete;
    Prepared& operator=(const Prepared&) = delete;

    [[nodiscard]] SurveyResult run(const SurveyOptions& options = {}) const { return run_survey(data, settings, start, options); }
    [[nodiscard]] filter::InertialModel model() const { return make_model(settings, make_layout(settings, recording)); }
    /// The filter at the end of the log, its covariance of that time.
    [[nodiscard]] filter::InertialFilter<Frame> end(filter::PassObserver<Frame>& observer) const {
        const filter::InertialModel m = model();
        const filter::Pass<Frame> pass(m, data, settings);
        filter::FilterRun<Frame> run = filter::first_step<Frame>(m, data, settings, start);
        run.next_output = Time{INT64_MAX};
        while (run.event < data.events.size() && data.events[run.event].valid <= start.nav.time) ++run.event;
        pass.advance(run, data.imu.increments.size() - 1, observer);
        pass.propagate_covariance(run, observer);
        return run.filter;
    }
};

/// Where the reference begins, with errors drawn from their sigmas.
inline NavState erring_start(const sim::Scenario& scenario, const sim::SimulatedData& data, const Beliefs& beliefs) {
    math::Random random(scenario.seed, "start errors");
    const ReferenceSample& first = data.recording.reference.front();
    NavState right{first.time, first.position, first.velocity_n, math::quaternion_from_rpy(first.rpy)};
    const Eigen::Vector3d tilt = beliefs.attitude_n.cwiseProduct(random.normal3());
    right.q_nb = math::quaternion_from_rotation_vector(tilt) * right.q_nb;
    NavStateEcef start = ins::to_ecef(scenario.earth, right);
    start.position.r += beliefs.position * random.normal3();
    start.v_eb_e += beliefs.velocity * random.normal3();
    return ins::to_geographic(scenario.earth, start);
}

}  // namespace schuler::gravimetry::test
