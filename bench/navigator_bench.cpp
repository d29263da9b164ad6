// The navigator fed sample by sample: throughput beside the batch's, and how long one `feed` takes.
#include "schuler/core/units.h"
#include "schuler/filter/navigator.h"
#include "schuler/fusion/run_pass.h"
#include "schuler/fusion/still.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/tune.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/simulate.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

namespace {

using namespace schuler;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// Time of the processor, which others on the machine do not lengthen, s.
double processor_time() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Ten minutes of a town drive at 200 Hz, fixes at 1 Hz.
struct Drive {
    Recording recording;
    fusion::Settings settings;
    double interval = 0.0;  // s
    filter::Start start;
};

const Drive& drive() {
    static const Drive data = [] {
        sim::Scenario s;
        s.seed = 1;
        s.duration = 600.0;
        s.origin = Time::from_seconds(1000.0);
        s.path = sim::town_route({50.4 * units::deg, 30.5 * units::deg, 150.0}, s.duration, 7);
        s.imu.errors = sensor::imu_grade("mems");
        s.imu.rate = 200.0;
        s.gnss.rate = 1.0;
        sim::SimulatedData simulated = sim::simulate(s);
        Drive d{std::move(simulated.recording), {}, 0.005, {}};
        d.settings.imu.kind = simulated.imu_kind;
        d.settings.imu.errors = sensor::imu_grade("mems");
        d.settings.constraints.zero_velocity = false;
        d.settings.gnss.estimate_std = false;
        const ReferenceSample& truth = d.recording.reference.front();
        d.start.nav = {truth.time, truth.position, truth.velocity_n, math::quaternion_from_rpy(truth.rpy)};
        d.start.std_position = d.start.std_velocity = Eigen::Vector3d::Ones();
        d.start.std_rpy = d.start.std_gyro_bias = d.start.std_accel_bias = Eigen::Vector3d::Constant(0.01);
        return d;
    }();
    return data;
}

/// What a batch does with samples: increments, events, standing still, doubtful stretches, and the forward walk, whose time is `walk`.
double batch(const Drive& d, const fusion::Settings& settings, double& walk) {
    const double begin = processor_time();
    WarningLog unheard;
    fusion::RunData data;
    data.recording = &d.recording;
    data.imu = fusion::make_imu_timeline(d.recording.imu, settings.imu, unheard);
    filter::set_limits(data, settings);
    data.events = fusion::make_events(d.recording, settings, Time{}, unheard);
    data.fix_noise = fusion::fix_noise(d.recording, settings.gnss, unheard);
    data.still = fusion::find_still(data.imu, d.recording, data.events, settings);
    const double prepared = processor_time();
    const fusion::Result result = fusion::run_pass(data, settings, d.start, {});
    benchmark::DoNotOptimize(result.forward.rows.size());
    const double end = processor_time();
    walk = end - prepared;
    return end - begin;
}

filter::Navigator navigator(const Drive& d, const fusion::Settings& settings) {
    filter::NavigatorSettings n;
    n.filter = settings;
    n.imu_interval = d.interval;
    n.start = d.start;
    return std::move(*filter::Navigator::make(n).navigator);
}

/// Feeds the drive, fixes where they belong among the samples of the IMU; `each` is called around every sample.
template <class Each>
void feed_all(const Drive& d, filter::Navigator& navigator, Each&& each) {
    std::size_t k = 0;
    for (const ImuSample& s : d.recording.imu) {
        for (; k < d.recording.gnss.size() && d.recording.gnss[k].time <= s.time; ++k)
            each([&] { (void)navigator.feed(d.recording.gnss[k]); });
        each([&] { (void)navigator.feed(s); });
        while (navigator.poll_row()) {}
    }
}

fusion::Settings settings_with(bool scale_factors) {
    fusion::Settings s = drive().settings;
    s.scale_factors = scale_factors;
    return s;
}

void batch_and_stream(benchmark::State& state, bool scale_factors) {
    const Drive& d = drive();
    const fusion::Settings settings = settings_with(scale_factors);
    double batch_time = 0.0, walk_time = 0.0, stream = 0.0;
    std::vector<double> over_batch, over_walk;
    for (auto _ : state) {  // in pairs, for the machine's mood changes
        double walk = 0.0;
        const double b = batch(d, settings, walk);
        filter::Navigator n = navigator(d, settings);
        const double begin = processor_time();
        feed_all(d, n, [](auto&& feed) { feed(); });
        const double s = processor_time() - begin;
        batch_time += b;
        walk_time += walk;
        stream += s;
        over_batch.push_back(s / b);
        over_walk.push_back(s / walk);
        state.SetIterationTime(s);
    }
    const double epochs = static_cast<double>(d.recording.imu.size()) * static_cast<double>(state.iterations());
    state.counters["batch_epochs_per_s"] = epochs / batch_time;
    state.counters["stream_epochs_per_s"] = epochs / stream;
    state.counters["walk_epochs_per_s"] = epochs / walk_time;
    state.counters["stream_over_batch"] = math::median(over_batch);
    state.counters["stream_over_walk"] = math::median(over_walk);
}

/// asked: the state at the newest sample is asked for after each sample, within the time.
void latency(benchmark::State& state, bool scale_factors, bool asked) {
    const Drive& d = drive();
    std::vector<double> times;
    for (auto _ : state) {
        filter::Navigator n = navigator(d, settings_with(scale_factors));
        const Clock::time_point begin = Clock::now();
        feed_all(d, n, [&](auto&& feed) {
            const Clock::time_point from = Clock::now();
            feed();
            if (asked) benchmark::DoNotOptimize(n.state());
            times.push_back(seconds_since(from));
        });
        state.SetIterationTime(seconds_since(begin));
    }
    std::sort(times.begin(), times.end());
    const auto at = [&](double q) { return 1e6 * times[static_cast<std::size_t>(q * static_cast<double>(times.size() - 1))]; };
    state.counters["median_us"] = at(0.5);
    state.counters["p99_us"] = at(0.99);
    state.counters["p999_us"] = at(0.999);
    state.counters["longest_us"] = at(1.0);
}

BENCHMARK_CAPTURE(batch_and_stream, states_15, false)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(15);
BENCHMARK_CAPTURE(batch_and_stream, states_21, true)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(15);
BENCHMARK_CAPTURE(latency, feed_15, false, false)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK_CAPTURE(latency, feed_21, true, false)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK_CAPTURE(latency, feed_and_state_21, true, true)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace

BENCHMARK_MAIN();
