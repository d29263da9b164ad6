#include "schuler/fusion/heading_search.h"

#include "schuler/core/units.h"
#include "schuler/fusion/tuning/trial.h"
#include "schuler/ins/align.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::fusion {

using Eigen::Vector3d;

namespace {

constexpr int headings = 36;      // so close that a linearised filter is consistent in each: 24 deg are too far with large biases
constexpr double temper = 4.0;    // of log-likelihoods
constexpr double refuted = 12.0;  // of tempered ones: such a trial is not continued
constexpr double clear = 10.0 * units::deg;  // one sigma of a decided heading

struct Trial {
    Start start;
    StartEstimate found;
    double log_weight = 0.0;
    [[nodiscard]] double heading() const { return math::rpy_from_quaternion(found.nav.q_nb).z(); }
    [[nodiscard]] double std() const { return found.std_rpy.z(); }
};

/// Sorted by weight, without the rejected ones.
void weigh(std::vector<Trial>& trials, const std::optional<HeadingWitness>& witness) {
    for (Trial& t : trials) {
        t.log_weight = t.found.log_likelihood / temper;
        if (!witness) continue;
        const double off = math::wrap_pi(t.heading() - witness->heading) / std::hypot(witness->std, t.std());
        t.log_weight -= 0.5 * off * off;
    }
    std::ranges::sort(trials, std::greater{}, &Trial::log_weight);
    const double least = trials.front().log_weight - refuted;
    std::erase_if(trials, [least](const Trial& t) { return t.log_weight < least; });
}

/// Mean and spread of the mixture about it.
void mix(const std::vector<Trial>& trials, HeadingSearch& search) {
    double x = 0.0, y = 0.0, sum = 0.0;
    for (const Trial& t : trials) {
        const double w = std::exp(t.log_weight - trials.front().log_weight);
        x += w * std::cos(t.heading());
        y += w * std::sin(t.heading());
        sum += w;
    }
    search.heading = std::atan2(y, x);
    double variance = 0.0;
    for (const Trial& t : trials) {
        const double w = std::exp(t.log_weight - trials.front().log_weight) / sum,
                     off = math::wrap_pi(t.heading() - search.heading);
        variance += w * (t.std() * t.std() + off * off);
    }
    search.std = std::sqrt(variance);
    search.best = trials.front().found;
}

/// Fixes with a time uncertainty of some tenths of a second are wrong by the distance travelled, and the velocity change, in that
/// time. Added to the noise of the fixes, because the effect of a wrong attitude is far larger.
void allow_for_latency(RunData& data, const GnssSettings& gnss) {
    const double of_velocity = gnss.velocity_latency_std > 0.0 ? gnss.velocity_latency_std : gnss.latency_std;
    if (!(gnss.latency_std > 0.0 || of_velocity > 0.0)) return;
    constexpr double apart = 0.4;  // s, least interval between fixes for a rate of change
    const std::vector<GnssFix>& fixes = data.recording->gnss;
    const earth::Earth earth;
    std::size_t before = 0, after = 0;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
        while (before + 1 < i && (fixes[i].time - fixes[before + 1].time).seconds() > apart) ++before;
        after = std::max(after, i);
        while (after + 1 < fixes.size() && (fixes[after].time - fixes[i].time).seconds() < apart) ++after;
        const double dt = (fixes[after].time - fixes[before].time).seconds();
        if (!(dt > 0.0)) continue;
        const Vector3d travelled = earth::ned_difference(earth, fixes[after].position, fixes[before].position) / dt;
        const Vector3d gained = (fixes[after].velocity_n - fixes[before].velocity_n) / dt;
        for (int k = 0; k < 3; ++k) {
            FixNoise& noise = data.fix_noise[i];
            const auto widen = [](double& sigma, double late, double rate) {
                if (std::isfinite(rate)) sigma = std::hypot(sigma, late * rate);
            };
            for (double* sigma : {&noise.position(k), &noise.white_position(k)}) widen(*sigma, gnss.latency_std, travelled(k));
            for (double* sigma : {&noise.velocity(k), &noise.white_velocity(k)}) widen(*sigma, of_velocity, gained(k));
        }
    }
}

}  // namespace

double unknown_lever_arm_std(const Settings& settings) {
    constexpr double mast = 10.0;  // m
    return settings.vehicle == VehicleKind::Ship ? mast : settings.gnss.lever_arm_std;
}

HeadingSearch search_heading(const RunData& all, const Settings& settings, const Start& given, const Level& level, Time motion,
                             const std::optional<HeadingWitness>& witness) {
    RunData data = gnss_only(all);
    allow_for_latency(data, settings.gnss);
    Settings settings_of_trial = trial_settings(settings);
    // Where the unit or the antenna is shaken, a wrong latency looks like a wrong heading, and does so at each fix: the trials estimate
    // both, beside the noise.
    settings_of_trial.gnss.latency_std = settings.gnss.latency_std;
    settings_of_trial.gnss.velocity_latency_std = settings.gnss.velocity_latency_std;
    // Velocity errors common to successive fixes, taken for white, would let a few seconds decide for a wrong heading.
    settings_of_trial.gnss.errors.correlated_velocity = settings.gnss.errors.correlated_velocity;
    settings_of_trial.gnss.errors.correlated_velocity_time = settings.gnss.errors.correlated_velocity_time;
    // The motion of an antenna about the unit, in waves or in a swinging hand, looks like one of the unit with another heading. A car's
    // antenna moves so only as the car turns, which accelerates it by far more.
    settings_of_trial.estimate_lever_arm =
        settings.vehicle != VehicleKind::Car && (settings.estimate_lever_arm || settings.gnss.lever_arm_b.isZero(0.0));
    if (!settings.estimate_lever_arm) settings_of_trial.gnss.lever_arm_std = unknown_lever_arm_std(settings);
    Start start = given;
    start.std_rpy = Vector3d(level.std, level.std, 1.2 * std::numbers::pi / headings);
    std::vector<Start> starts(headings, start);
    for (int k = 0; k < headings; ++k)
        starts[static_cast<std::size_t>(k)].nav.q_nb =
            ins::attitude_from_specific_force(level.f_b, level.f_n, 2.0 * std::numbers::pi * k / headings);
    HeadingSearch search;
    const Time end = data.imu.increments.back().time;
    for (const double span : {15.0, 60.0, 240.0, 960.0}) {
        search.until = std::min(end, std::max(motion, start.nav.time) + Duration::from_seconds(span));
        const std::size_t last = increment_at(data, search.until);
        std::vector<Trial> trials;
        for (const Start& s : starts) trials.push_back({s, smooth_start(data, settings_of_trial, s, last)});
        weigh(trials, witness);
        mix(trials, search);
        search.decided = search.std < clear;
        if (search.decided) {
            // Repeated from the best result: its errors are small, so the linearised filter is judged where it is valid.
            Start refined = start;
            refined.nav = search.best.nav;
            refined.at_antenna = false;
            refined.gyro_bias = search.best.gyro_bias;
            search.best = smooth_start(data, settings_of_trial, refined, last);
            search.decided = search.best.std_rpy.z() < clear;
        }
        if (search.decided || search.until == end) break;
        starts.clear();
        for (const Trial& t : trials) starts.push_back(t.start);
    }
    return search;
}

std::optional<Level> carried_level(const RunData& data, const Settings& settings, const Start& start) {
    constexpr double longest = 20.0, shortest = 2.0;  // s
    const double gyro_bias = start.std_gyro_bias.maxCoeff();
    const double span = std::clamp(4.0 * units::deg / gyro_bias, shortest, longest);
    struct Point {
        double t;
        Vector3d v;
        double std;
    };
    std::vector<Point> points;
    for (const Event& e : data.events) {
        if (e.kind != MeasurementKind::GnssVelocity || e.withheld || e.components != 7 || e.valid < start.nav.time) continue;
        const double t = (e.valid - start.nav.time).seconds();
        if (t > span + 1.0) break;
        points.push_back({t, data.recording->gnss[e.index].velocity_n, data.fix_noise[e.index].velocity.maxCoeff()});
    }
    if (points.size() < 2 || points.back().t - points.front().t < std::max(shortest - 1.0, 0.5 * span)) return std::nullopt;
    const double from = points.front().t, length = points.back().t - from;
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  // to the axes of the start
    Vector3d sum = Vector3d::Zero();
    double t = 0.0, total = 0.0;
    for (std::size_t i = start.increment; i < data.imu.increments.size() && t < from + length; ++i) {
        const ImuIncrement& inc = data.imu.increments[i];
        const Eigen::Quaterniond half = math::quaternion_from_rotation_vector(0.5 * (inc.dtheta - start.gyro_bias * inc.dt));
        t += inc.dt;
        if (t > from) {
            sum += (q * half) * inc.dv;
            total += inc.dt;
        }
        q = q * half * half;
    }
    if (!(total > 0.5 * length)) return std::nullopt;
    const double g = earth::gravity_down(settings.earth.gravity, start.nav.position.lat, start.nav.position.h);
    Level level;
    level.f_b = sum / total;
    level.f_n = (points.back().v - points.front().v) / length - Vector3d(0.0, 0.0, g);
    const double receiver = std::hypot(points.front().std, points.back().std) / (length * g);
    const double sensors = std::hypot(1.5 * start.std_accel_bias.maxCoeff() / g, 0.5 * gyro_bias * (from + length));
    level.std = std::max(1.0 * units::deg, std::hypot(receiver, sensors));
    return level;
}

}  // namespace schuler::fusion
