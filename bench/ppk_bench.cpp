// Carrier-phase positions: an hour at 1 Hz with two systems on two carriers, made here in memory. Reading the files is rinex_bench's.
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/constellation.h"
#include "schuler/math/random.h"
#include "schuler/ppk/solve.h"
#include "schuler/ppk/tracking.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <functional>

namespace {

using namespace schuler;

const Time start = Time::from_gps(2300, 200'000.0);
const Geodetic origin{0.85, 0.16, 320.0};

gnss::Navigation sky() {
    gnss::Navigation out = gnss::nominal_gps(start, start + Duration::from_seconds(3600.0));
    for (gnss::KeplerEphemeris k : std::vector(out.kepler)) {
        k.satellite.system = gnss::System::Galileo;
        k.m0 += 0.55;
        k.omega0 += 0.4;
        out.kepler.push_back(k);
    }
    return out;
}

gnss::ObservationLog measured(const gnss::Navigation& navigation, const std::function<Ecef(double)>& place, std::uint64_t seed) {
    const gnss::BroadcastSource source(navigation);
    math::Random random(seed, "bench");
    gnss::ObservationLog log;
    log.approximate = place(0.0);
    for (double t = 0.0; t < 3600.0; t += 1.0) {
        const Time tag = start + Duration::from_seconds(t);
        const Ecef at = place(t);
        const Geodetic geodetic = earth::geodetic_from_ecef(earth::wgs84, at);
        gnss::ObservationEpoch epoch;
        epoch.time = tag;
        epoch.first = log.observations.size();
        for (const gnss::SatelliteId id : gnss::satellites_of(navigation)) {
            ppk::TrackedSatellite s;
            s.id = id;
            ppk::Line line;
            line.range = 2.2e7;
            for (int i = 0; i < 4; ++i) {
                const auto found = source.at(id, {}, tag - Duration::from_seconds(line.range / gnss::speed_of_light));
                if (!found) break;
                s.position = found->state.position;
                line = ppk::line_to(s, at, geodetic);
            }
            if (line.direction.elevation < 0.1) continue;
            for (const gnss::Signal signal :
                 {gnss::Signal{'1', 'C'}, gnss::Signal{id.system == gnss::System::Gps ? '2' : '5', 'X'}}) {
                gnss::SignalObservation o;
                o.satellite = id;
                o.signal = signal;
                o.pseudorange = line.range + 0.5 * random.normal();
                o.phase =
                    (line.range + 0.003 * random.normal()) * gnss::frequency_of(id.system, signal.band) / gnss::speed_of_light +
                    1000.0 * id.number;
                log.observations.push_back(o);
            }
        }
        epoch.count = log.observations.size() - epoch.first;
        log.epochs.push_back(epoch);
    }
    return log;
}

void hour(benchmark::State& state) {
    const gnss::Navigation navigation = sky();
    const gnss::BroadcastSource source(navigation);
    const Ecef o = earth::ecef_from_geodetic(earth::wgs84, origin);
    const Eigen::Matrix3d C_en = earth::C_en(origin.lat, origin.lon);
    const gnss::ObservationLog base = measured(
        navigation, [&](double) { return o; }, 1);
    const gnss::ObservationLog rover = measured(
        navigation,
        [&](double t) {
            return Ecef{o.r + C_en * Eigen::Vector3d(900.0 + 40.0 * std::cos(t / 8.0), 1200.0 + 40.0 * std::sin(t / 8.0), -15.0)};
        },
        2);
    ppk::Input input;
    input.rover = &rover;
    input.base = &base;
    input.source = &source;
    input.single.ranges.ionosphere = gnss::IonosphereModel::None;
    input.single.ranges.troposphere = gnss::TroposphereModel::None;
    ppk::Settings settings;
    settings.air.troposphere = false;
    settings.direction = state.range(0) == 0 ? ppk::Direction::Forward : ppk::Direction::Combined;
    for (auto _ : state) {
        WarningLog warnings;
        benchmark::DoNotOptimize(ppk::solve(input, settings, warnings).epochs.data());
    }
    state.counters["signals"] = static_cast<double>(rover.observations.size()) / static_cast<double>(rover.epochs.size());
}
BENCHMARK(hour)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
