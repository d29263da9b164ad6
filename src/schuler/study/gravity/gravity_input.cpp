#include "schuler/earth/enu.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/fusion/start.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/tune.h"
#include "schuler/gravimetry/survey_run.h"
#include "schuler/math/rotation.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"
#include "schuler/study/gravity/gravity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace schuler::study {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The loosely coupled smoother over the same data: start and attitude if not given by the user.
fusion::Result coarse(const solution::LoadedDataset& data, WarningLog& warnings) {
    fusion::Settings s = data.config.filter;
    s.smooth = true;
    s.loop = fusion::Loop::Closed;  // filter.loop is that of the survey
    s.backward = false;
    s.output_rate = 1.0;
    s.output_at_antenna = false;  // the survey is that of the unit
    fusion::Result result = fusion::run_filter(data.recording, s, warnings);
    if (result.smoothed.rows.empty())
        throw computation_error("no start was found for gravimetry", "give [initial] position, velocity and attitude");
    return result;
}

/// Adds a disturbance to the increments as sensed by an accelerometer.
void inject(std::vector<ImuIncrement>& imu, const std::vector<sim::AnomalyPart>& parts, const std::vector<SolutionRow>& rows,
            Time origin, std::uint64_t seed) {
    double extent = 0.0;
    for (std::size_t i = 1; i < rows.size(); ++i) extent += rows[i].v_eb_n.norm() * (rows[i].time - rows[i - 1].time).seconds();
    const sim::AnomalyTrack track(parts, extent, (imu.back().time - origin).seconds(), seed);
    double distance = 0.0;
    std::size_t next = 0;
    for (ImuIncrement& increment : imu) {
        while (next + 1 < rows.size() && rows[next].time < increment.time) ++next;
        distance += increment.dt * rows[next].v_eb_n.norm();
        const Matrix3d C_bn = math::dcm_from_rpy(rows[next].rpy).transpose();
        increment.dv -= increment.dt * (C_bn * track.at(distance, (increment.time - origin).seconds()));
    }
}

SolutionRow given_start(const fusion::InitialSettings& i, Time time) {
    return {i.time.value_or(time), i.position, i.velocity_n, i.rpy, i.std_position, i.std_velocity, i.std_rpy};
}

fusion::DisturbanceSettings disturbance_of(const settings::GravityConfig& g) {
    const bool by_time = std::isfinite(g.time);
    const auto given = [](double x) { return std::isfinite(x) ? x : 0.0; };
    return {.estimate = true,
            .model = {g.model, by_time ? g.time : g.length, earth::sigma_swapped(g.sigma_enu), by_time, g.axes},
            .prior_n = earth::sigma_swapped(g.prior_enu),
            .slope = given(g.slope),
            .curvature = given(g.curvature)};
}

/// Constant errors of the receiver are slow errors with infinite correlation time.
void take_systematic_errors(const settings::GravityConfig& g, sensor::GnssErrorModel& errors) {
    constexpr double never = std::numeric_limits<double>::infinity();
    if (std::isfinite(g.gnss_position)) {
        errors.correlated_position.setConstant(g.gnss_position);
        errors.correlated_time = never;
        errors.correlated_distance = 0.0;
    }
    if (g.gnss_velocity > 0.0) {
        errors.correlated_velocity.setConstant(g.gnss_velocity);
        errors.correlated_velocity_time = never;
    }
}

/// Metres per second between the fixes.
double mean_speed(const std::vector<GnssFix>& fixes, const earth::Earth& earth) {
    double distance = 0.0;
    for (std::size_t i = 1; i < fixes.size(); ++i)
        distance += fixes[i].velocity_n.allFinite()
                        ? fixes[i].velocity_n.norm() * (fixes[i].time - fixes[i - 1].time).seconds()
                        : earth::ned_difference(earth, fixes[i].position, fixes[i - 1].position).norm();
    return distance / std::max(1e-9, (fixes.back().time - fixes.front().time).seconds());
}

/// The time in which the disturbance is the same: the survey, or the correlation time of its variable part.
double steady_time(const filter::DisturbanceModel& model, double span, double speed) {
    if (!model.has_random_part() || !(model.length > 0.0)) return span;
    return std::min(span, model.by_time ? model.length : model.length / std::max(speed, 1e-9));
}

/// Sensor errors that vary many times while the disturbance is the same average out like white noise of their density at zero
/// frequency. In addition to a constant sensor error, represented by the bias state, they are modelled in this way: modelled as a
/// random walk of that state, which is valid for times shorter than their correlation, they would mask the disturbance.
void take_coloured_noise(double steady, sensor::ImuErrorModel& e) {
    const auto take = [&](double& bias, double time, double constant, double& noise) {
        if (!(constant > 0.0 && bias > 0.0 && time > 0.0 && time < 0.1 * steady)) return;
        noise = std::hypot(noise, bias * std::sqrt(2.0 * time));
        bias = 0.0;
    };
    take(e.accel_bias, e.accel_bias_time, e.accel_turn_on_bias, e.accel_noise);
    take(e.gyro_bias, e.gyro_bias_time, e.gyro_turn_on_bias, e.gyro_noise);
}

/// The barometer as one gauge with a constant error.
void take_barometer(const solution::LoadedDataset& data, Recording& recording, fusion::Settings& settings) {
    const SourcePlace place{{}, 0, 0, "gravity.height_aid"};
    if (data.recording.baro.empty())
        throw input_error("there is no barometer or depth gauge", place, "name its log in [baro], or leave the key out");
    if (!data.recording.gauges.empty())
        throw input_error("the gauges of [gauges] are taken already", place, "leave out one of them");
    settings.gauges = {.std = settings.baro.std, .level_std = settings.baro.bias_std};
    for (const BaroSample& b : data.recording.baro) recording.gauges.push_back({b.time, {b.height, not_given, not_given}});
}

/// The assumptions of a run in the form used by covariance analysis.
gravimetry::SurveySettings beliefs_of(const fusion::Settings& filter, const fusion::Start& start) {
    const sensor::ImuErrorModel& imu = filter.imu.errors;
    gravimetry::SurveySettings s;
    s.earth = filter.earth;
    s.disturbance = filter.disturbance.model;
    s.lever_arm_b = filter.gnss.lever_arm_b;
    const auto walk = [](double sigma, double time) { return std::isfinite(time) ? 2.0 * sigma * sigma / time : 0.0; };
    s.noise = {imu.gyro_noise * imu.gyro_noise, imu.accel_noise * imu.accel_noise, walk(imu.gyro_bias, imu.gyro_bias_time),
               walk(imu.accel_bias, imu.accel_bias_time)};
    s.prior.attitude_n = start.std_rpy;
    s.prior.velocity = start.std_velocity.maxCoeff();
    s.prior.position = start.std_position.maxCoeff();
    s.prior.accel_bias = start.std_accel_bias.maxCoeff();
    s.prior.gyro_bias = start.std_gyro_bias.maxCoeff();
    s.prior.gnss_position_n = filter.gnss.errors.correlated_position;
    s.prior.gnss_velocity = filter.gnss.errors.correlated_velocity.maxCoeff();
    s.prior.disturbance_n = filter.disturbance.prior_n;
    s.prior.slope = filter.disturbance.slope;
    s.prior.curvature = filter.disturbance.curvature;
    return s;
}

/// Noise of the used fixes, their rate and the speed between them. @throws Error(Input) if there are none
gravimetry::VerticalMotion motion_of(const GravityInput& in) {
    gravimetry::VerticalMotion m{0.0, 0.0, 1.0, 0.0};
    double n = 0.0, moving = 0.0, distance = 0.0;
    const GnssFix *first = nullptr, *last = nullptr;
    const Time from = in.start.nav.time, to = in.data.imu.increments.back().time;
    for (const fusion::Event& e : in.data.events) {
        if (e.withheld || e.valid < from || e.valid > to) continue;
        const fusion::FixNoise& noise = in.data.fix_noise[e.index];
        if (e.kind == fusion::MeasurementKind::GnssVelocity && (e.components & 4) != 0) {
            m.sigma_velocity += noise.white_velocity.z();
            moving += 1.0;
        }
        if (e.kind != fusion::MeasurementKind::GnssPosition || (e.components & 3) != 3) continue;
        const GnssFix& fix = in.recording->gnss[e.index];
        m.sigma_position += noise.white_position.z();
        n += 1.0;
        if (last != nullptr)
            distance += fix.velocity_n.allFinite() ? fix.velocity_n.norm() * (fix.time - last->time).seconds()
                                                   : earth::ned_difference(in.filter.earth, fix.position, last->position).norm();
        if (first == nullptr) first = &fix;
        last = &fix;
    }
    if (n < 1.0) throw input_error("no satellite fix can be used", {}, "check the times of both logs with `schuler inspect`");
    const double span = (last->time - first->time).seconds();
    m.sigma_position /= n;
    m.sigma_velocity = moving > 0.0 ? m.sigma_velocity / moving : std::numeric_limits<double>::infinity();
    if (span > 0.0) {
        m.rate = (n - 1.0) / span;
        m.speed = distance / span;
    }
    return m;
}

}  // namespace

GravityInput gravity_input(const solution::LoadedDataset& data, WarningLog& warnings) {
    const settings::Config& c = data.config;
    if (data.recording.imu.empty() || data.recording.gnss.empty())
        throw input_error(data.recording.imu.empty() ? "the IMU log is empty" : "gravimetry needs satellite fixes", {},
                          "give an IMU log and a GNSS log of the same time");
    GravityInput out;
    fusion::RunData& run = out.data;
    run.imu = fusion::make_imu_timeline(data.recording.imu, c.filter.imu, warnings);
    const fusion::InitialSettings& initial = c.filter.initial;
    const Time first = run.imu.increments.front().time - Duration::from_seconds(run.imu.increments.front().dt);
    const bool given = fusion::gives_start(initial) && !(c.filter.start && *c.filter.start > first);
    SolutionRow start = given_start(initial, first);
    fusion::Settings settings = c.filter;
    if (!given || !c.gravity.inject.empty()) {
        const fusion::Result loose = coarse(data, warnings);
        if (!given) start = loose.smoothed.rows.front();
        if (loose.findings.in_force) settings = *loose.findings.in_force;
        settings.loop = c.filter.loop;
        WarningLog heard;  // already
        run.imu = fusion::make_imu_timeline(data.recording.imu, settings.imu, heard);
        if (!c.gravity.inject.empty()) inject(run.imu.increments, c.gravity.inject, loose.smoothed.rows, data.origin, 1);
    }
    out.filter = gravimetry::gravity27(std::move(settings), disturbance_of(c.gravity));
    take_systematic_errors(c.gravity, out.filter.gnss.errors);
    const double span = (run.imu.increments.back().time - run.imu.increments.front().time).seconds();
    take_coloured_noise(steady_time(out.filter.disturbance.model, span, mean_speed(data.recording.gnss, c.filter.earth)),
                        out.filter.imu.errors);
    Recording recording;
    recording.gnss = data.recording.gnss;
    recording.heading = data.recording.heading;
    recording.gauges = data.recording.gauges;
    recording.body_velocity = data.recording.body_velocity;
    if (c.gravity.height_aid) take_barometer(data, recording, out.filter);
    out.recording = std::make_unique<const Recording>(std::move(recording));

    std::vector<ImuIncrement>& imu = run.imu.increments;
    if (c.filter.stop) std::erase_if(imu, [&](const ImuIncrement& i) { return i.time > *c.filter.stop; });
    // The filter starts at the start of an increment.
    const double half = 0.5 * run.imu.median_dt;
    const auto begin = std::ranges::find_if(imu, [&](const ImuIncrement& i) { return (i.time - start.time).seconds() >= half; });
    if (begin == imu.end())
        throw input_error("the start lies after the IMU log", {{}, 0, 0, "initial.time_s"}, "give a time within the log");
    out.start.increment = static_cast<std::size_t>(begin - imu.begin());
    out.start.nav = {begin->time - Duration::from_seconds(begin->dt), start.position, start.v_eb_n,
                     math::quaternion_from_rpy(start.rpy)};
    out.start.std_position = start.std_position;
    out.start.std_velocity = start.std_velocity;
    const double level = start.std_rpy.head<2>().maxCoeff();
    out.start.std_rpy = {level, level, start.std_rpy.z()};
    out.start.gyro_bias = initial.gyro_bias;
    out.start.accel_bias = initial.accel_bias;
    out.start.std_gyro_bias.setConstant(out.filter.imu.errors.gyro_initial_bias());
    out.start.std_accel_bias.setConstant(out.filter.imu.errors.accel_initial_bias());

    run.recording = out.recording.get();
    run.origin = data.origin;
    fusion::set_limits(run, out.filter);
    const fusion::FixScreen screen = fusion::screen_fixes(out.recording->gnss, out.filter, data.origin, warnings);
    run.events = fusion::make_events(*out.recording, out.filter, data.origin, warnings, screen);
    run.fix_noise = fusion::fix_noise(*out.recording, out.filter.gnss, warnings);
    for (const double t : c.gravity.steps) {
        out.steps.push_back(data.origin + Duration::from_seconds(t));
        if (out.steps.back() <= out.start.nav.time || out.steps.back() >= imu.back().time)
            warnings.add(fmt::format("gravity.steps_s {}", t), fmt::format("gravity.steps_s: {:g} s lies outside the survey", t));
    }
    out.settings = beliefs_of(out.filter, out.start);
    out.motion = motion_of(out);
    return out;
}

}  // namespace schuler::study
