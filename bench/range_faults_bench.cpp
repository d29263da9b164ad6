// Faults in the range of one satellite on the flight of examples/triad-all.toml: does the tight filter with its watch stay inside its
// sigmas? A table, a line a fault; docs/triad.md.
//   bench_range_faults SEEDS [SATELLITE...]
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/gnss/constellation.h"
#include "schuler/sim/ranging.h"
#include "schuler/sim/simulate.h"
#include "schuler/sim/weave.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using namespace schuler;
using Eigen::Vector3d;

constexpr double fault_start = 200.0, fault_duration = 400.0, settled = 100.0;  // s

struct Flight {
    Recording recording;
    fusion::Settings settings;
    earth::Earth earth;
};

/// As examples/triad-all.toml.
Flight flight(std::uint64_t seed, std::vector<sim::RangeFault> faults, bool watch) {
    Flight f;
    sim::Scenario s;
    s.seed = seed;
    s.duration = 780.0;
    sim::WeavingFlight weave;
    weave.start = {52.3 * units::deg, 104.3 * units::deg, 10000.0};
    s.path = sim::weaving_path(weave, f.earth.ellipsoid);
    s.imu.rate = 10.0;
    sensor::ImuErrorModel& imu = s.imu.errors;
    imu = sensor::imu_grade("perfect");
    imu.gyro_bias = 0.01 * units::deg / 3600.0;
    imu.gyro_noise = 0.003 * units::deg / 60.0;
    imu.accel_bias = 0.05e-3 * units::g0;
    imu.accel_noise = 0.02;
    s.gnss.rate = 0.0;
    s.baro.rate = 1.0;
    s.baro.white = 1.0;
    s.baro.bias = 30.0;
    s.baro.bias_time = 2000.0;
    s.reference_rate = 1.0;
    f.recording = sim::simulate(s).recording;
    const sim::RangingScenario frame{seed, s.duration, {}, Time::from_gps(2300, 0.0), f.earth};
    sim::RangingSettings r;
    r.lever_arm_b = {2.0, 0.5, -3.0};
    r.navigation = gnss::nominal_gps(frame.gps, frame.gps + Duration::from_seconds(s.duration));
    r.masks.throughout = true;
    r.faults = std::move(faults);
    f.recording.ranges = sim::simulate_ranges(frame, *sim::make_path(s.path, f.earth.ellipsoid), r).log;
    fusion::Settings& t = f.settings;
    t.coupling = fusion::Coupling::Tight;
    t.vehicle = fusion::VehicleKind::Air;
    t.imu.kind = ImuKind::Increments;
    t.imu.errors = imu;
    t.gnss.lever_arm_b = r.lever_arm_b;
    t.constraints.zero_velocity = false;
    t.ranging.corrections.troposphere = gnss::TroposphereModel::None;
    t.ranging.corrections.ionosphere = gnss::IonosphereModel::None;
    t.ranging.protection.use = watch;
    t.baro.std = s.baro.white;
    t.baro.bias_std = s.baro.bias;
    t.baro.bias_time = s.baro.bias_time;
    t.output_rate = 1.0;
    const ReferenceSample& truth = f.recording.reference.front();
    t.initial = {truth.time,
                 truth.position,
                 truth.velocity_n,
                 truth.rpy,
                 Vector3d::Constant(10.0),
                 Vector3d::Constant(0.1),
                 Vector3d(0.005, 0.005, 0.05) * units::deg,
                 Vector3d::Zero(),
                 Vector3d::Zero()};
    return f;
}

/// Sums over runs, of epochs from `settled` on.
struct Sums {
    double error2 = 0.0, sigma2 = 0.0, nees = 0.0, largest = 0.0;
    int epochs = 0, inside = 0, runs = 0, right = 0, wrong = 0;
    std::vector<double> to_alarm;

    void add(const Flight& f, const std::string& spoilt) {
        WarningLog unheard;
        const fusion::Result result = fusion::run_filter(f.recording, f.settings, unheard);
        for (const SolutionRow& row : result.forward.rows) {
            const double t = row.time.seconds();
            const auto k = static_cast<std::size_t>(std::llround(t));
            if (t < settled || k >= f.recording.reference.size()) continue;
            const Vector3d e = earth::ned_difference(f.earth, row.position, f.recording.reference[k].position);
            const Vector3d normal = e.cwiseQuotient(row.std_position);
            error2 += e.squaredNorm();
            sigma2 += row.std_position.squaredNorm();
            nees += normal.squaredNorm() / 3.0;
            largest = std::max(largest, e.norm());
            inside += normal.cwiseAbs().maxCoeff() < 3.0 ? 1 : 0;
            ++epochs;
        }
        bool named = false, other = false;
        for (const fusion::ProtectionRow& row : result.forward.protection) {
            if (row.alarm < 0) continue;
            if (f.recording.ranges.sources[static_cast<std::size_t>(row.alarm)].name != spoilt) {
                other = true;
                continue;
            }
            if (!named) to_alarm.push_back(row.time.seconds() - fault_start);
            named = true;
        }
        ++runs;
        right += named ? 1 : 0;
        wrong += other ? 1 : 0;
    }

    void print(const std::string& what) {
        std::ranges::sort(to_alarm);
        fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {:.1f} % | {} of {} | {} | {} |\n", what,
                   std::sqrt(error2 / epochs), largest, std::sqrt(sigma2 / epochs), nees / epochs, 100.0 * inside / epochs, right,
                   runs, wrong, to_alarm.empty() ? std::string("-") : fmt::format("{:.0f}", to_alarm[to_alarm.size() / 2]));
    }
};

}  // namespace

int main(int argc, char** argv) {
    const std::uint64_t seeds = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 0;
    if (seeds == 0) {  // bench/run asks all programs for timings, and this one has none
        fmt::print(stderr, "bench_range_faults SEEDS [SATELLITE...]\n");
        return 2;
    }
    std::vector<std::string> satellites(argv + std::min(argc, 2), argv + argc);
    if (satellites.empty()) satellites = {"G02", "G05", "G10"};
    fmt::print(
        "| fault | RMS error, m | largest, m | RMS sigma, m | NEES/3 | inside 3 sigma | named | another named | to alarm, s |\n"
        "|---|---|---|---|---|---|---|---|---|\n");
    for (const bool watch : {false, true}) {
        Sums sums;
        for (std::uint64_t seed = 1; seed <= seeds * satellites.size(); ++seed) sums.add(flight(seed, {}, watch), "");
        sums.print(watch ? "none" : "none, without the watch");
    }
    const auto measure = [&](const std::string& what, double offset, double ramp, double rate) {
        Sums sums;
        for (const std::string& satellite : satellites)
            for (std::uint64_t seed = 1; seed <= seeds; ++seed)
                sums.add(flight(seed, {{satellite, fault_start, fault_duration, offset, ramp, rate}}, true), satellite);
        sums.print(what);
    };
    for (const double ramp : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0}) measure(fmt::format("ramp {} m/s", ramp), 0.0, ramp, 0.0);
    for (const double ramp : {0.2, 1.0}) measure(fmt::format("ramp {} m/s of the range alone", ramp), 0.0, ramp, -ramp);
    for (const double step : {5.0, 10.0, 20.0, 50.0, 300.0}) measure(fmt::format("step {} m", step), step, 0.0, 0.0);
}
