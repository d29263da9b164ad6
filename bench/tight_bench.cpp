// Speed of the tightly coupled filter alone: 200 Hz increments, 10 Hz epochs of 24 satellites with range and rate, correlated errors as
// states.
#include "schuler/core/units.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/gnss/constellation.h"
#include "schuler/sim/ranging.h"
#include "schuler/sim/simulate.h"
#include "schuler/sim/weave.h"

#include <benchmark/benchmark.h>

namespace {

using namespace schuler;

/// Two minutes of flight; the earth is no obstacle, so that there are 24 satellites.
const Recording& flight() {
    static const Recording recording = [] {
        sim::Scenario s;
        s.duration = 120.0;
        sim::WeavingFlight weave;
        weave.start = {52.3 * units::deg, 104.3 * units::deg, 3000.0};
        weave.duration = s.duration;
        s.path = sim::weaving_path(weave, s.earth.ellipsoid);
        s.imu.rate = 200.0;
        s.imu.errors = sensor::imu_grade("tactical");
        s.gnss.rate = 0.0;
        Recording r = sim::simulate(s).recording;
        const Time gps = Time::from_gps(2300, 7200.0), end = gps + Duration::from_seconds(s.duration);
        sim::RangingSettings ranging;
        ranging.rate = 10.0;
        ranging.navigation = gnss::nominal_gps(gps, end);
        ranging.navigation.add(gnss::nominal_glonass(gps, end));
        ranging.masks.elevation = -1.5;
        ranging.limits.push_back({0.0, 24, 0});
        r.ranges =
            sim::simulate_ranges({1, s.duration, {}, gps, s.earth}, *sim::make_path(s.path, s.earth.ellipsoid), ranging).log;
        return r;
    }();
    return recording;
}

void forward(benchmark::State& state, fusion::Mechanization mechanization) {
    const Recording& data = flight();
    fusion::Settings settings;
    settings.coupling = fusion::Coupling::Tight;
    settings.mechanization = mechanization;
    settings.imu.kind = ImuKind::Increments;
    settings.imu.errors = sensor::imu_grade("tactical");
    settings.ranging.corrections.troposphere = gnss::TroposphereModel::None;
    settings.ranging.corrections.ionosphere = gnss::IonosphereModel::None;
    settings.ranging.corrections.elevation_mask = -2.0;
    settings.constraints.zero_velocity = false;
    const ReferenceSample& truth = data.reference.front();
    settings.initial.position = truth.position;
    settings.initial.velocity_n = truth.velocity_n;
    settings.initial.rpy = truth.rpy;
    settings.initial.std_rpy = Eigen::Vector3d::Constant(0.001);
    double seconds = 0.0;
    for (auto _ : state) {
        WarningLog unheard;
        const fusion::Result result = fusion::run_filter(data, settings, unheard);
        seconds += result.filter_seconds;
        state.SetIterationTime(result.filter_seconds);
    }
    state.counters["satellites"] = static_cast<double>(data.ranges.epochs.front().count);
    state.counters["epochs_per_s"] = static_cast<double>(data.imu.size()) * static_cast<double>(state.iterations()) / seconds;
}

BENCHMARK_CAPTURE(forward, geographic, fusion::Mechanization::Geographic)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(forward, ecef, fusion::Mechanization::Ecef)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
