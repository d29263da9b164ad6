// A simulated car as a batch and as a stream: what the tests of the navigator share.
#pragma once

#include "fusion/car_drive.h"

#include "schuler/filter/navigator.h"
#include "schuler/fusion/run_pass.h"
#include "schuler/fusion/start.h"
#include "schuler/fusion/still.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/tune.h"
#include "schuler/math/random.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

namespace schuler::fusion::testing {

/// A log with every instrument, a given start, and settings that leave nothing to be found.
struct StreamLog {
    Recording recording;
    Settings settings;
};

inline StreamLog car_log(std::uint64_t seed, double duration = 50.0) {
    sim::Scenario scenario = town_drive(seed, 5.0, duration);
    scenario.baro.rate = 5.0;
    shake(scenario);
    std::get<sim::RoutePath>(scenario.path).standstill = 25.0;
    StreamLog log{sim::simulate(scenario).recording, settings_of(scenario)};
    math::Random random(seed, "stream instruments");
    for (const ReferenceSample& t : log.recording.reference) {
        const Eigen::Matrix3d C_nb = math::dcm_from_rpy(t.rpy);
        log.recording.odometer.push_back({t.time, 1.01 * C_nb.col(0).dot(t.velocity_n) + 0.05 * random.normal(), 0.05});
        log.recording.heading.push_back({t.time + Duration{3'000'000}, t.rpy.z() + 0.01 * random.normal(), 0.01});
        log.recording.mag.push_back({t.time, C_nb.transpose() * Eigen::Vector3d(2e-5, 0.0, 4e-5)});
        log.recording.gauges.push_back({t.time, Eigen::Vector3d(t.position.h + 0.1 * random.normal(), t.position.h - 0.3, NAN)});
        log.recording.body_velocity.push_back(
            {t.time, C_nb.transpose() * t.velocity_n + 0.05 * Eigen::Vector3d(random.normal(), 0.0, 0.0)});
    }
    // a receiver whose fixes are told a tenth of a second late, and are valid inside of increments
    for (GnssFix& fix : log.recording.gnss) fix.time = fix.time + Duration{103'000'000};
    Settings& f = log.settings;
    f.gnss.estimate_std = false;
    f.gnss.latency = 0.103;
    f.gnss.velocity_latency = 0.106;
    f.constraints.nonholonomic = true;
    f.scale_factors = true;
    return log;
}

/// A receiver that jumps, one that is dragged away, and a unit whose bias jumps: the hypotheses about who is wrong come and go.
inline StreamLog disputed_log(std::uint64_t seed) {
    StreamLog log = car_log(seed, 120.0);
    for (GnssFix& f : log.recording.gnss) {
        const double t = f.time.seconds() - 1000.0;
        if (t > 60.0 && t < 75.0) f.position.lat += 1e-6 * (t - 60.0);
        if (t > 35.0 && t < 40.0) f.position.lon += 4e-6;
    }
    for (ImuSample& s : log.recording.imu) {
        const double t = s.time.seconds() - 1000.0;
        if (t > 90.0 && t < 91.5) {
            s.accel += Eigen::Vector3d(0.0, 8.0, 0.0);
            s.gyro += Eigen::Vector3d(0.0, 0.0, 0.5);
        }
    }
    return log;
}

/// The batch: its data, its start and its rows.
struct Batch {
    RunData data;
    Start start;
    std::vector<SolutionRow> rows;
};

inline Start true_start(const RunData& data, const Recording& recording, double after) {
    const ReferenceSample& truth = *std::ranges::find_if(recording.reference, [&](const ReferenceSample& r) {
        return (r.time - recording.reference.front().time).seconds() >= after;
    });
    Start start;
    start.increment = static_cast<std::size_t>(
        std::ranges::find_if(data.imu.increments,
                             [&](const ImuIncrement& i) { return i.time > truth.time + Duration{100'000}; }) -
        data.imu.increments.begin());
    if (start.increment > 0) start.previous = data.imu.increments[start.increment - 1];
    const ImuIncrement& first = data.imu.increments[start.increment];
    start.nav = {first.time - Duration::from_seconds(first.dt), truth.position, truth.velocity_n,
                 math::quaternion_from_rpy(truth.rpy)};
    start.std_position = Eigen::Vector3d::Constant(2.0);
    start.std_velocity = Eigen::Vector3d::Constant(0.2);
    start.std_rpy = Eigen::Vector3d::Constant(0.02);
    start.std_gyro_bias = Eigen::Vector3d::Constant(2e-4);
    start.std_accel_bias = Eigen::Vector3d::Constant(0.02);
    return start;
}

inline Batch run_batch(const Recording& recording, const Settings& settings, double start_after = 1.0) {
    WarningLog unheard;
    Batch batch;
    RunData& data = batch.data;
    data.recording = &recording;
    data.imu = make_imu_timeline(recording.imu, settings.imu, unheard);
    if (data.imu.gaps == 0) data.imu.bridges.clear();  // what only a whole log makes doubtful
    set_limits(data, settings);
    data.events = make_events(recording, settings, Time{}, unheard);
    data.fix_noise = fix_noise(recording, settings.gnss, unheard);
    data.still = find_still(data.imu, recording, data.events, settings);
    batch.start = true_start(data, recording, start_after);
    batch.rows = run_pass(data, settings, batch.start, {}).forward.rows;
    return batch;
}

/// One sample of any instrument; a range epoch by its index.
struct Sample {
    Time arrival;
    std::variant<ImuSample, GnssFix, BaroSample, MagSample, OdometerSample, HeadingSample, GaugeSample, BodyVelocitySample,
                 std::size_t>
        what;
};

/// All samples in the order of their stamps.
inline std::vector<Sample> samples_of(const Recording& r) {
    std::vector<Sample> all;
    const auto add = [&](const auto& list) {
        for (const auto& s : list) all.push_back({s.time, s});
    };
    add(r.imu);
    add(r.gnss);
    add(r.baro);
    add(r.mag);
    add(r.odometer);
    add(r.heading);
    add(r.gauges);
    add(r.body_velocity);
    for (std::size_t i = 0; i < r.ranges.epochs.size(); ++i) all.push_back({r.ranges.epochs[i].time, i});
    std::ranges::stable_sort(all, {}, &Sample::arrival);
    return all;
}

inline NavigatorSettings stream_settings(const Recording& r, const Settings& settings, const Batch& batch) {
    NavigatorSettings n;
    n.filter = settings;
    n.imu_interval = batch.data.imu.median_dt;
    const auto rate = [](const auto& list) { return list.empty() ? 0.0 : 20.0; };
    n.rates = {10.0,           rate(r.baro),          rate(r.mag),   rate(r.odometer), rate(r.heading),
               rate(r.gauges), rate(r.body_velocity), rate(r.ranges)};
    n.rates.gauge_count = r.gauges.empty() ? 0 : 2;
    n.still = batch.data.still.thresholds;
    n.still_delay = 0.65;
    n.start = batch.start;
    return n;
}

inline FeedStatus feed(Navigator& navigator, const Sample& sample, const RangingLog& ranges) {
    return std::visit(
        [&]<class T>(const T& what) {
            if constexpr (std::is_same_v<T, std::size_t>)
                return navigator.feed(ranges.epochs[what].time, ranges.of(ranges.epochs[what]));
            else return navigator.feed(what);
        },
        sample.what);
}

/// Feeds all and returns the rows that come out.
inline std::vector<SolutionRow> stream(Navigator& navigator, const std::vector<Sample>& samples, const RangingLog& ranges) {
    for (const RangeSource& s : ranges.sources) (void)navigator.range_source(s.name, s.station);
    std::vector<SolutionRow> rows;
    for (const Sample& s : samples) {
        (void)feed(navigator, s, ranges);
        while (const std::optional<SolutionRow> row = navigator.poll_row()) rows.push_back(*row);
    }
    return rows;
}

/// How many rows two solutions begin with that are the same to the last bit.
inline std::size_t same_bits(const std::vector<SolutionRow>& a, const std::vector<SolutionRow>& b) {
    const auto numbers = [](const SolutionRow& r) {
        std::vector<std::uint64_t> x{std::bit_cast<std::uint64_t>(r.time.ns), std::bit_cast<std::uint64_t>(r.position.lat),
                                     std::bit_cast<std::uint64_t>(r.position.lon), std::bit_cast<std::uint64_t>(r.position.h)};
        for (const Eigen::Vector3d& v : {r.v_eb_n, r.rpy, r.std_position, r.std_velocity, r.std_rpy})
            for (int i = 0; i < 3; ++i) x.push_back(std::bit_cast<std::uint64_t>(v(i)));
        return x;
    };
    std::size_t n = 0;
    while (n < std::min(a.size(), b.size()) && numbers(a[n]) == numbers(b[n])) ++n;
    return n;
}

/// The same samples, each late by less than `lag` seconds at random; those of the IMU by less than `imu_lag`.
inline std::vector<Sample> shuffled(std::vector<Sample> samples, double lag, double imu_lag, std::uint64_t seed) {
    math::Random random(seed, "arrival");
    for (Sample& s : samples) {
        const double late = std::holds_alternative<ImuSample>(s.what) ? imu_lag : lag;
        s.arrival = s.arrival + Duration::from_seconds(late * random.uniform());
    }
    std::ranges::stable_sort(samples, {}, &Sample::arrival);
    return samples;
}

}  // namespace schuler::fusion::testing
