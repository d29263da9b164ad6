// Speed of the loosely coupled filter alone: increments in memory, covariance propagated at every epoch, GNSS at 1 Hz.
#include "schuler/core/units.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/simulate.h"

#include <benchmark/benchmark.h>

namespace {

using namespace schuler;

/// Ten minutes of a town drive at 200 Hz.
const sim::SimulatedData& drive() {
    static const sim::SimulatedData data = [] {
        sim::Scenario s;
        s.seed = 1;
        s.duration = 600.0;
        s.origin = Time::from_seconds(1000.0);
        s.path = sim::town_route({50.4 * units::deg, 30.5 * units::deg, 150.0}, s.duration, 7);
        s.imu.errors = sensor::imu_grade("mems");
        s.imu.rate = 200.0;
        s.gnss.rate = 1.0;
        return sim::simulate(s);
    }();
    return data;
}

/// states: 15 or 21 (with scale factors). Reported: IMU epochs a second in the filter, without reading and start-up.
void forward(benchmark::State& state, bool scale_factors, fusion::Mechanization mechanization) {
    const sim::SimulatedData& data = drive();
    fusion::Settings settings;
    settings.mechanization = mechanization;
    settings.scale_factors = scale_factors;
    settings.imu.kind = data.imu_kind;
    settings.imu.errors = sensor::imu_grade("mems");
    const ReferenceSample& truth = data.recording.reference.front();
    settings.initial.position = truth.position;
    settings.initial.velocity_n = truth.velocity_n;
    settings.initial.rpy = truth.rpy;
    settings.initial.std_rpy = Eigen::Vector3d::Constant(0.01);
    settings.constraints.zero_velocity = false;
    double seconds = 0.0;
    for (auto _ : state) {
        WarningLog unheard;
        const fusion::Result result = fusion::run_filter(data.recording, settings, unheard);
        seconds += result.filter_seconds;
        state.SetIterationTime(result.filter_seconds);
    }
    state.counters["epochs_per_s"] =
        static_cast<double>(data.recording.imu.size()) * static_cast<double>(state.iterations()) / seconds;
}

BENCHMARK_CAPTURE(forward, states_15_geographic, false, fusion::Mechanization::Geographic)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(forward, states_21_geographic, true, fusion::Mechanization::Geographic)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(forward, states_21_ecef, true, fusion::Mechanization::Ecef)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
