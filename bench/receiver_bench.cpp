// How much faster than real time a receiver of twelve channels runs on one core: correlator level with tracking, and samples.
#include "schuler/receiver/deep_channel.h"
#include "schuler/receiver/if_samples.h"
#include "schuler/receiver/tracker.h"

#include <benchmark/benchmark.h>

namespace {

using namespace schuler::receiver;
constexpr int channels = 12;

/// A second of twelve channels at 45 dB-Hz; `real_time` is seconds of signal a second of processor.
void report(benchmark::State& state) {
    state.counters["real_time"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void correlator_level_tracking(benchmark::State& state) {
    const SignalStructure signal = gps_l1_ca();
    const CorrelatorModel model(CorrelationPeak(signal.chip_rate, 8e6), 0.5);
    schuler::math::Random random(1, "bench");
    std::vector<Tracker> trackers(channels, Tracker(signal, model.peak(), {}));
    std::vector<LineOfSight> truth;
    for (int i = 0; i < channels; ++i) {
        truth.push_back({2.2e7 + 1e5 * i, 100.0 * i - 600.0, 1.0, 0.0});
        trackers[static_cast<std::size_t>(i)].start(aligned_replica(signal, truth.back()), 0);
    }
    const double cn0 = cn0_from_db(45.0), T = signal.code_period();
    for (auto _ : state) {
        for (int ms = 0; ms < 1000; ++ms) {
            for (std::size_t i = 0; i < channels; ++i) {
                trackers[i].step(
                    model.dump(replica_error(signal, trackers[i].replica(), truth[i], T), cn0, T, ms % 40 < 20 ? 1 : -1, random));
                truth[i] = truth[i].after(T);
            }
        }
    }
    int locked = 0;
    for (const Tracker& t : trackers) locked += t.phase_locked() ? 1 : 0;
    state.counters["locked"] = locked;
    report(state);
}
BENCHMARK(correlator_level_tracking)->Unit(benchmark::kMillisecond);

void correlator_level_deep(benchmark::State& state) {
    const SignalStructure signal = gps_l1_ca();
    const CorrelatorModel model(CorrelationPeak(signal.chip_rate, 8e6), 0.5);
    schuler::math::Random random(1, "bench");
    DeepSettings settings;
    settings.prefilter = state.range(0) == 0 ? Prefilter::Noncoherent : Prefilter::Coherent;
    std::vector<DeepChannel> deep(channels, DeepChannel(signal, model.peak(), settings));
    LineOfSight truth{2.2e7, 300.0, 0.0, 0.0};
    for (DeepChannel& c : deep) c.start(truth, 0);
    const double cn0 = cn0_from_db(45.0), T = signal.code_period();
    for (auto _ : state) {
        for (int ms = 0; ms < 1000; ++ms) {
            for (DeepChannel& c : deep)
                benchmark::DoNotOptimize(c.step(model.dump(replica_error(signal, c.replica(), truth, T), cn0, T, 1, random)));
            truth = truth.after(T);
        }
    }
    report(state);
}
BENCHMARK(correlator_level_deep)->Arg(0)->Arg(1)->ArgName("coherent")->Unit(benchmark::kMillisecond);

void sample_level_tracking(benchmark::State& state) {
    const IfFormat format{4e6, 0.0};
    const SignalStructure signal = gps_l1_ca();
    const std::size_t n = format.samples_per_period();
    std::vector<IfSatellite> sky;
    for (int i = 0; i < channels; ++i)
        sky.push_back({i + 1, {2.2e7 + 1e5 * i, 100.0 * i - 600.0, 0.0, 0.0}, cn0_from_db(45.0), 1});
    constexpr std::size_t seconds = 1;
    std::vector<IfSample> samples(n * 1000 * seconds);
    IfGenerator generator(format, sky, 1);
    for (std::size_t ms = 0; ms < 1000 * seconds; ++ms) generator.generate(std::span(samples).subspan(ms * n, n));
    for (auto _ : state) {
        for (std::size_t i = 0; i < channels; ++i) {
            Tracker tracker(signal, CorrelationPeak(signal.chip_rate), {});
            SampleCorrelator correlator(format, sky[i].prn, 0.5);
            tracker.start(aligned_replica(signal, sky[i].motion), 0);
            for (std::size_t ms = 0; ms < 1000; ++ms) {
                const std::span<const IfSample> block(samples.data() + ms * n, n);
                tracker.step(correlator.correlate(block, 1e-3 * static_cast<double>(ms), tracker.replica(), 24.0));
            }
            benchmark::DoNotOptimize(tracker.cn0());
        }
    }
    report(state);
}
BENCHMARK(sample_level_tracking)->Unit(benchmark::kMillisecond);

void acquisition(benchmark::State& state) {
    const IfFormat format{4e6, 0.0};
    const FftAcquisition search(format);
    std::vector<IfSample> samples(search.samples_needed());
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = {static_cast<std::int8_t>(i * 7 % 31), static_cast<std::int8_t>(i * 11 % 29)};
    for (auto _ : state) benchmark::DoNotOptimize(search.acquire(samples, 5).statistic);
}
BENCHMARK(acquisition)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
