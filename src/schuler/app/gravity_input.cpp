#include "schuler/app/gravity.h"
#include "schuler/earth/enu.h"
#include "schuler/filter/correction_period.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/fusion/timeline.h"
#include "schuler/gravimetry/resolution.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>

namespace schuler::app {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using gravimetry::AntennaFix;

Vector3d or_default(const Vector3d& given, const Vector3d& otherwise) { return (given.array() > 0.0).all() ? given : otherwise; }

/// The white part of a sigma of which `systematic` is a state of its own.
Vector3d without(const Vector3d& sigma, const Vector3d& systematic) {
    return (sigma.cwiseAbs2() - systematic.cwiseAbs2()).array().max(0.01 * sigma.cwiseAbs2().array()).sqrt().matrix();
}

bool withheld(const fusion::Settings& s, Time time, Time origin) {
    const double t = (time - origin).seconds();
    return std::ranges::any_of(s.outages, [t](const fusion::Outage& o) { return t > o.start && t < o.start + o.duration; });
}

std::vector<AntennaFix> fixes_of(const LoadedDataset& data, const gravimetry::Prior& prior) {
    const fusion::Settings& s = data.config.filter;
    std::vector<AntennaFix> out;
    for (const GnssFix& fix : data.recording.gnss) {
        const bool located = std::isfinite(fix.position.lat) && std::isfinite(fix.position.lon) && std::isfinite(fix.position.h);
        if (fix.fix == FixType::None || !located || withheld(s, fix.time, data.origin)) continue;
        if ((s.start && fix.time < *s.start) || (s.stop && fix.time > *s.stop)) continue;
        if (!out.empty() && fix.time <= out.back().time) continue;
        const Matrix3d C_en = earth::C_en(fix.position.lat, fix.position.lon);
        AntennaFix a;
        a.time = fix.time - Duration::from_seconds(s.gnss.latency + fix.position_age);
        a.position = earth::ecef_from_geodetic(s.earth.ellipsoid, fix.position).r;
        a.sigma_position_n = without(
            or_default(fix.std_position, s.gnss.default_std_position).cwiseMax(s.gnss.std_floor_position), prior.gnss_position_n);
        const bool moving = s.gnss.use_velocity && fix.velocity_n.allFinite();
        a.velocity = moving ? Vector3d(C_en * fix.velocity_n) : Vector3d::Zero();
        a.sigma_velocity_n =
            moving ? without(or_default(fix.std_velocity, s.gnss.default_std_velocity), Vector3d::Constant(prior.gnss_velocity))
                   : Vector3d::Constant(std::numeric_limits<double>::infinity());
        out.push_back(a);
    }
    return out;
}

/// The loosely coupled smoother over the same data: start and attitude where the user gives none.
fusion::Result coarse(const LoadedDataset& data, WarningLog& warnings) {
    fusion::Settings s = data.config.filter;
    s.smooth = true;
    s.loop = fusion::Loop::Closed;   // filter.loop is that of the survey
    s.output_rate = 1.0;
    fusion::Result result = fusion::run_filter(data.recording, s, warnings);
    if (result.smoothed.rows.empty())
        throw computation_error("no start was found for gravimetry", "give [initial] position, velocity and attitude");
    return result;
}

/// Injects a disturbance into the increments: what an accelerometer would have felt of it.
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

/// Priors: the sensors' from their error model, gravity's from [gravity], the start's from its sigmas.
gravimetry::SurveySettings settings_of(const Config& c, const SolutionRow& start) {
    const sensor::ImuErrorModel& imu = c.filter.imu.errors;
    const GravityConfig& g = c.gravity;
    gravimetry::SurveySettings s;
    s.earth = c.filter.earth;
    s.lever_arm_b = c.filter.gnss.lever_arm_b;
    const bool by_time = std::isfinite(g.time);
    s.disturbance = {g.model, by_time ? g.time : g.length, earth::sigma_swapped(g.sigma_enu), by_time, g.axes};
    const auto walk = [](double sigma, double time) { return std::isfinite(time) ? 2.0 * sigma * sigma / time : 0.0; };
    s.noise = {imu.gyro_noise * imu.gyro_noise, imu.accel_noise * imu.accel_noise, walk(imu.gyro_bias, imu.gyro_bias_time),
               walk(imu.accel_bias, imu.accel_bias_time)};
    gravimetry::Prior& p = s.prior;
    const double level = std::max(start.std_rpy.x(), start.std_rpy.y());
    p.attitude_n = {level, level, start.std_rpy.z()};
    p.velocity = start.std_velocity.maxCoeff();
    p.position = start.std_position.maxCoeff();
    p.accel_bias = imu.accel_initial_bias();
    p.gyro_bias = imu.gyro_initial_bias();
    p.gnss_position_n =
        std::isfinite(g.gnss_position) ? Vector3d(Vector3d::Constant(g.gnss_position)) : c.filter.gnss.errors.correlated_position;
    p.gnss_velocity = g.gnss_velocity;
    p.disturbance_n = earth::sigma_swapped(g.prior_enu);
    p.slope = g.slope;
    p.curvature = g.curvature;
    s.loop = c.filter.loop;
    // A disturbance that nobody corrects for acts like an accelerometer's error.
    const auto bounds = fusion::three_sigma(level, p.gyro_bias, std::hypot(p.accel_bias, p.disturbance_n.head<2>().maxCoeff()));
    s.feedback_period = c.filter.feedback_period.value_or(fusion::correction_period(bounds, c.filter.feedback_attitude));
    return s;
}

/// Gauges, log of velocity and compass, and the barometer where gravity is to have it: measurements and priors.
void take_aids(const LoadedDataset& data, GravityInput& out) {
    const Config& c = data.config;
    const AidsConfig& aids = c.aids;
    gravimetry::SurveySettings& settings = out.settings;
    gravimetry::Prior& prior = settings.prior;
    if (c.gravity.height_aid) {
        const SourcePlace place{{}, 0, 0, "gravity.height_aid"};
        if (data.recording.baro.empty())
            throw input_error("there is no barometer or depth gauge to take", place,
                              "name its log in [baro], or leave the key out");
        if (!data.aids.gauges.empty())
            throw input_error("the gauges of [gauges] are taken already", place, "leave out one of them");
        prior.height_bias = c.filter.baro.bias_std;
        for (const BaroSample& b : data.recording.baro)
            if (std::isfinite(b.height)) out.survey.heights.push_back({b.time, b.height, c.filter.baro.std, 0});
    }
    if (!data.aids.gauges.empty()) prior.height_bias = aids.gauges.bias;
    for (std::size_t i = 0; i < aids.gauges.lever_arms_b.size(); ++i)
        settings.gauge_lever_arms_b[i] = aids.gauges.lever_arms_b[i];
    for (const GaugeSample& s : data.aids.gauges)
        for (int i = 0; i < static_cast<int>(aids.gauges.lever_arms_b.size()); ++i)
            if (std::isfinite(s.height(i))) out.survey.heights.push_back({s.time, s.height(i), aids.gauges.white, i});
    settings.log_lever_arm_b = aids.log.lever_arm_b;
    prior.log_scale = aids.log.scale;
    prior.log_misalignment = aids.log.misalignment;
    for (const BodyVelocitySample& s : data.aids.velocities)
        out.survey.velocities.push_back({s.time, s.velocity_b, Vector3d::Constant(aids.log.white)});
    prior.heading_bias = aids.compass.bias;
    for (const HeadingSample& s : data.aids.headings) out.survey.headings.push_back({s.time, s.heading, aids.compass.white});
}

}  // namespace

GravityInput gravity_input(const LoadedDataset& data, WarningLog& warnings) {
    const Config& c = data.config;
    fusion::ImuTimeline timeline = fusion::make_imu_timeline(data.recording.imu, c.filter.imu, warnings);
    std::vector<ImuIncrement>& imu = timeline.increments;
    if (c.filter.stop) std::erase_if(imu, [&](const ImuIncrement& i) { return i.time > *c.filter.stop; });
    if (imu.empty() || data.recording.gnss.empty())
        throw input_error(
            imu.empty() ? "the IMU log has no sample before the end of the run" : "gravimetry needs satellite fixes", {},
            "give an IMU log and a GNSS log of the same time");
    const fusion::InitialSettings& initial = c.filter.initial;
    const Time first = imu.front().time - Duration::from_seconds(imu.front().dt);
    const bool given = initial.rpy.allFinite() && initial.velocity_n.allFinite() && std::isfinite(initial.position.lat) &&
                       initial.std_rpy.allFinite() && initial.std_velocity.allFinite() && initial.std_position.allFinite() &&
                       !(c.filter.start && *c.filter.start > first);
    SolutionRow start = given_start(initial, first);
    double accel_noise = 0.0, gyro_noise = 0.0;
    if (!given || !c.gravity.inject.empty()) {
        const fusion::Result loose = coarse(data, warnings);
        if (!given) start = loose.smoothed.rows.front();
        if (c.filter.imu.estimate_noise) {
            accel_noise = loose.findings.accel_noise;
            gyro_noise = loose.findings.gyro_noise;
        }
        if (!c.gravity.inject.empty()) inject(imu, c.gravity.inject, loose.smoothed.rows, data.origin, 1);
    }
    // The filter begins where an increment begins.
    const double half = 0.5 * timeline.median_dt;
    std::erase_if(imu, [&](const ImuIncrement& i) { return (i.time - start.time).seconds() < half; });
    if (imu.empty())
        throw input_error("the start lies after the IMU log", {{}, 0, 0, "initial.time_s"}, "give a time within the log");
    GravityInput out;
    out.gaps = timeline.gaps;
    out.settings = settings_of(c, start);
    out.settings.noise.accel_psd = std::max(out.settings.noise.accel_psd, accel_noise * accel_noise);
    out.settings.noise.gyro_psd = std::max(out.settings.noise.gyro_psd, gyro_noise * gyro_noise);
    NavState nav{imu.front().time - Duration::from_seconds(imu.front().dt), start.position, start.v_eb_n,
                 math::quaternion_from_rpy(start.rpy)};
    out.survey.start = ins::to_ecef(out.settings.earth, nav);
    out.survey.imu = std::move(imu);
    out.survey.fixes = fixes_of(data, out.settings.prior);
    if (out.survey.fixes.empty())
        throw input_error("no satellite fix can be used", {}, "check the times of both logs with `schuler inspect`");
    for (const double t : c.gravity.steps) out.survey.steps.push_back(data.origin + Duration::from_seconds(t));
    take_aids(data, out);
    const AntennaFix& a = out.survey.fixes.front();
    double distance = 0.0;
    for (std::size_t i = 1; i < out.survey.fixes.size(); ++i)
        distance +=
            std::isfinite(out.survey.fixes[i].sigma_velocity_n.x())
                ? out.survey.fixes[i].velocity.norm() * (out.survey.fixes[i].time - out.survey.fixes[i - 1].time).seconds()
                : (out.survey.fixes[i].position - out.survey.fixes[i - 1].position).norm();
    const double span = (out.survey.fixes.back().time - a.time).seconds();
    out.mean_speed = span > 0.0 ? distance / span : 0.0;
    return out;
}

}  // namespace schuler::app
