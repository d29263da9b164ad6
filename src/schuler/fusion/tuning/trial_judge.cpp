#include "schuler/fusion/tuning/trial_judge.h"

#include "schuler/fusion/start.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/trial.h"
#include "schuler/fusion/tuning/tune.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>

namespace schuler::fusion {
namespace {

/// Data at rest say little about a receiver's or unit's errors in motion, and logs begin and end with minutes of it.
constexpr double weight_at_rest = 0.1;

/// Trials run for five minutes, or up to twenty with little motion until then: data at rest are not representative of later ones.
Time trial_end(const Recording& recording, Time begin) {
    constexpr double least = 300.0, most = 1200.0, least_moving = 240.0, slow = 2.0;  // s, m/s
    double moving = 0.0, last = 0.0;
    const GnssFix* before = nullptr;
    const earth::Earth earth;
    for (const GnssFix& fix : recording.gnss) {
        const double t = (fix.time - begin).seconds();
        if (t < 0.0 || !std::isfinite(fix.position.lat)) continue;
        if (t > most) break;
        if (t > least && moving > least_moving) return begin + Duration::from_seconds(std::max(least, last));
        last = t;
        if (before != nullptr) {
            const double dt = (fix.time - before->time).seconds();
            if (dt < 1.0) continue;
            if (earth::ned_difference(earth, fix.position, before->position).head<2>().norm() > slow * dt)
                moving += std::min(dt, 10.0);
        }
        before = &fix;
    }
    return begin + Duration::from_seconds(moving > 0.0 ? most : least);
}

}  // namespace

TrialJudge::TrialJudge(RunData& data, const Start& start, const GnssSettings& before, const FixScreen& screen)
    : data_(data),
      start_(start),
      latency_(before.latency),
      velocity_latency_(before.velocity_latency.value_or(before.latency)),
      screen_(screen),
      last_(data.imu.increments.size() - 1) {
    const Time stop = trial_end(*data.recording, start.nav.time);
    const auto it = std::lower_bound(data.imu.increments.begin(), data.imu.increments.end(), stop,
                                     [](const ImuIncrement& i, Time t) { return i.time < t; });
    last_ = std::min(last_, static_cast<std::size_t>(it - data.imu.increments.begin()));
    find_speeds(stop);
    find_spoiled();
    if (!before.use_velocity) return;
    const std::vector<bool> displaced = displaced_positions(data.recording->gnss, earth::Earth());
    screen_.position.resize(displaced.size(), false);
    for (std::size_t i = 0; i < displaced.size(); ++i) screen_.position[i] = screen_.position[i] || displaced[i];
}

double TrialJudge::cost(const Settings& settings, bool surroundings) {
    WarningLog unheard;
    data_.events = make_events(*data_.recording, settings, data_.origin, unheard, screen_);
    data_.fix_noise = fix_noise(*data_.recording, settings.gnss, unheard);
    Settings trial = plain_settings(settings);
    // Errors due to gains and axes in turns would be taken for noise, and for latency, without these states.
    trial.scale_factors = settings.scale_factors;
    trial.misalignments = settings.misalignments;
    trial.imu.gyro_noise_scale = trial.imu.accel_noise_scale = std::nullopt;  // of the noise to be found
    if (settings.gnss.estimate_latency) trial.gnss.latency_std = trial.gnss.velocity_latency_std = 0.0;  // to be found
    if (!surroundings) trial.baro.use = trial.mag.use = false;
    if (!surroundings)
        std::erase_if(data_.events,
                      [](const Event& e) { return e.kind == MeasurementKind::Baro || e.kind == MeasurementKind::Mag; });
    PassOptions options;
    options.outputs = false;
    options.rivalry = Rivalry::None;  // faster, and a likelihood independent of the outcome of contests
    options.last_increment = last_;
    const GnssSettings& g = settings.gnss;
    const Start start = with_later_fixes(start_, settings.earth, g.latency - latency_,
                                         g.velocity_latency.value_or(g.latency) - velocity_latency_);
    const Result run = run_pass(data_, trial, start, options);
    constexpr double first = 6.0, last = 1.0;  // s
    double sum = 0.0, n = 0.0;
    std::size_t at = 0;
    for (const MeasurementRecord& r : run.measurements) {
        const bool counts = is_part_of_fix(r.kind) || r.kind == MeasurementKind::Baro || r.kind == MeasurementKind::Mag;
        // By stamps, and away from the ends: the same samples for any latency.
        if (!counts || r.status == MeasurementStatus::Withheld || (r.stamp - start_.nav.time).seconds() < first ||
            (stop() - r.stamp).seconds() < last)
            continue;
        if (is_spoiled(r.stamp)) continue;
        while (at + 1 < speeds_.size() && speeds_[at + 1].first <= r.stamp) ++at;
        const double weight = speeds_.empty() || speeds_[at].second > slow_ ? 1.0 : weight_at_rest;
        for (int i = 0; i < 3; ++i) {
            if (!(r.sigma(i) > 0.0)) continue;
            const double x = std::abs(r.innovation(i)) / r.sigma(i);
            // Huber's tails: a few bad fixes must not dominate; one wrong by thousands of sigmas even less.
            constexpr double straight = 3.0, far = 10.0;
            const double tail = x < far ? straight * x : straight * far * (1.0 + std::log(x / far));
            sum += weight * (std::log(r.sigma(i)) + (x < straight ? 0.5 * x * x : tail - 0.5 * straight * straight));
            n += weight;
        }
    }
    count_ = n;
    return n > 0.0 ? sum / n : 1e9;
}

/// Speeds from the fixes, and which are slow: a quarter of the usual upper values.
void TrialJudge::find_speeds(Time stop) {
    const earth::Earth earth;
    const GnssFix* before = nullptr;
    std::vector<double> sorted;
    for (const GnssFix& fix : data_.recording->gnss) {
        if (fix.time < start_.nav.time || fix.time > stop || !std::isfinite(fix.position.lat)) continue;
        double speed = fix.velocity_n.head<2>().norm();
        if (!std::isfinite(speed)) {
            const double dt = before != nullptr ? (fix.time - before->time).seconds() : 0.0;
            speed = dt > 0.0 ? earth::ned_difference(earth, fix.position, before->position).head<2>().norm() / dt : 0.0;
        }
        before = &fix;
        speeds_.emplace_back(fix.time, speed);
        sorted.push_back(speed);
    }
    if (!sorted.empty()) slow_ = std::max(0.5, 0.25 * math::quantile(sorted, 0.95));  // m/s
}

/// Intervals with interpolated or unreliable inertial data, until their errors have decayed: interpolated motion, which is smooth,
/// would be taken for a latency. Short gaps and single shocks are ignored; if most of the log were affected, all of it is used.
void TrialJudge::find_spoiled() {
    constexpr double least = 0.75, fading = 10.0, lengths = 3.0, most = 0.6;  // s, s, of the log
    const auto& increments = data_.imu.increments;
    for (std::size_t k = 0; k < data_.imu.bridges.size();) {
        const std::size_t first = data_.imu.bridges[k].first;
        std::size_t last = data_.imu.bridges[k++].last;
        while (k < data_.imu.bridges.size() && data_.imu.bridges[k].first <= last + 1) last = data_.imu.bridges[k++].last;
        const double length = (increments[last].time - increments[first].time).seconds();
        if (length < least) continue;
        const double after = std::max(fading, lengths * length);
        spoiled_.emplace_back(increments[first].time, increments[last].time + Duration::from_seconds(after));
    }
    double sum = 0.0;
    Time until{INT64_MIN};
    for (const auto& [from, to] : spoiled_) {
        const Time begin = std::max({from, until, start_.nav.time}), end = std::min(to, stop());
        if (end > begin) sum += (end - begin).seconds();
        until = std::max(until, to);
    }
    if (sum > most * (stop() - start_.nav.time).seconds()) spoiled_.clear();
}

bool TrialJudge::is_spoiled(Time t) const {
    return std::ranges::any_of(spoiled_, [&](const auto& span) { return t >= span.first && t < span.second; });
}

}  // namespace schuler::fusion
