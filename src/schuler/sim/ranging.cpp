#include "schuler/sim/ranging.h"

#include "schuler/core/error.h"
#include "schuler/math/random.h"
#include "schuler/sim/detail/require.h"
#include "schuler/sim/detail/sight_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::sim {
namespace {

constexpr double c = gnss::speed_of_light;

using detail::require;
using detail::Transmitter;

void check(const RangingSettings& s) {
    require(s.rate > 0.0 && s.rate <= 1000.0, "ranges.rate_hz", "is not a rate", "give a positive number of Hz");
    require(s.multipath.period > 0.0, "ranges.multipath_period_s", "is not positive", "give seconds");
}

/// One source of ranges with its own slow error and random streams.
struct Source {
    Transmitter transmitter;
    sensor::RangeErrorModel errors;
    math::Random white, slow, rate, slow_rate;
    double correlated = 0.0, correlated_rate = 0.0, phase = 0.0;

    Source(const Transmitter& of, const sensor::RangeErrorModel& model, std::uint64_t seed)
        : transmitter(of),
          errors(model),
          white(seed, "ranges.white." + of.name),
          slow(seed, "ranges.slow." + of.name),
          rate(seed, "ranges.rate." + of.name),
          slow_rate(seed, "ranges.slow_rate." + of.name) {
        correlated = errors.correlated * slow.normal();
        correlated_rate = errors.correlated_rate * slow_rate.normal();
        phase = 2.0 * std::numbers::pi * slow.uniform();
    }
    void advance(double dt) {
        const double kept = std::exp(-dt / errors.correlation_time);
        correlated = kept * correlated + std::sqrt(1.0 - kept * kept) * errors.correlated * slow.normal();
        if (!(errors.correlated_rate > 0.0)) return;
        const double left = std::exp(-dt / errors.correlated_rate_time);
        correlated_rate = left * correlated_rate + std::sqrt(1.0 - left * left) * errors.correlated_rate * slow_rate.normal();
    }
};

class Simulation {
public:
    Simulation(const RangingScenario& s, const TruthPath& path, const RangingSettings& r) : s_(s), r_(r), lines_(s, path, r) {
        for (const Transmitter& t : lines_.transmitters())
            sources_.emplace_back(t, t.satellite ? r.errors.satellite : r.errors.station, s.seed);
    }

    SimulatedRanges run() {
        SimulatedRanges out;
        math::Random clock(s_.seed, "ranges.clock"), network(s_.seed, "ranges.network");
        const sensor::Oscillator& o = r_.errors.clock;
        double bias = o.bias * clock.normal(), drift = o.drift * clock.normal(), net = r_.errors.network * network.normal();
        const double dt = 1.0 / r_.rate;
        const auto epochs = static_cast<std::size_t>(std::floor(s_.duration * r_.rate + 1e-6));
        // covariance of the two integrals of the clock's noise over a step, by Cholesky
        const double q11 = o.phase_psd() * dt + o.frequency_psd() * dt * dt * dt / 3.0, q12 = o.frequency_psd() * dt * dt / 2.0;
        const double l11 = std::sqrt(q11), l21 = l11 > 0.0 ? q12 / l11 : 0.0;
        const double l22 = std::sqrt(std::max(0.0, o.frequency_psd() * dt - l21 * l21));
        for (std::size_t k = 1; k <= epochs; ++k) {
            const double t = static_cast<double>(k) / r_.rate;
            const double n1 = clock.normal(), n2 = clock.normal(), kept = std::exp(-dt / r_.errors.network_time);
            bias += drift * dt + l11 * n1;
            drift += l21 * n1 + l22 * n2;
            net = kept * net + std::sqrt(1.0 - kept * kept) * r_.errors.network * network.normal();
            const Time time = s_.origin + Duration::from_seconds(t);
            RangeEpoch epoch{time, out.log.samples.size(), 0};
            for (Source& source : sources_) {
                source.advance(dt);
                measure(source, t, bias, drift, net, out.log);
            }
            epoch.count = out.log.samples.size() - epoch.first;
            out.truth.push_back({time, bias, drift, net});
            if (epoch.count > 0) out.log.epochs.push_back(epoch);
        }
        return out;
    }

private:
    void measure(Source& source, double t, double bias, double drift, double network, RangingLog& log) {
        // every stream advances regardless of visibility, so that masking one satellite leaves the others' numbers unchanged
        const double white = source.white.normal(), rate_noise = source.rate.normal();
        const Transmitter& from = source.transmitter;
        if (!lines_.allowed(from)) return;
        const double instant = t - bias / c;  // true time at which the receiver's clock shows t
        const auto p = lines_.to(from, instant);
        if (!p || !lines_.above_masks(from, *p, instant) || lines_.silent(from, t)) return;
        constexpr double h = 0.05;
        const auto before = lines_.to(from, instant - h), after = lines_.to(from, instant + h);
        if (!before || !after) return;

        RangeSample m;
        m.source = log.source(from.name, !from.satellite);
        double fault = 0.0, fault_rate = 0.0;
        for (const RangeFault& f : r_.faults) {
            if (f.source != from.name || !f.active(t)) continue;
            fault += f.error(t);
            fault_rate += f.rate_error();
        }
        const double reflected = r_.multipath.amplitude * std::cos(p->direction.elevation) *
                                 std::sin(2.0 * std::numbers::pi * t / r_.multipath.period + source.phase);
        m.pseudorange =
            p->range + bias - c * p->transmitter.clock + source.errors.white * white + source.correlated + fault + reflected;
        m.range_rate = (after->range - before->range) / (2.0 * h) + drift - c * p->transmitter.clock_rate +
                       source.errors.rate * rate_noise + source.correlated_rate + fault_rate;
        if (!from.satellite) {
            m.pseudorange += network;
            m.range_rate = RangeSample::none;  // not transmitted in extended squitters
        } else {
            m.frequency = gnss::frequency_of(from.satellite->system, '1');
        }
        m.std = source.errors.white;
        m.std_rate = source.errors.rate;
        m.cn0 = 45.0;
        m.tx = p->transmitter.position;
        m.tx_velocity = p->transmitter.velocity;
        m.tx_clock = p->transmitter.clock;
        m.tx_clock_rate = p->transmitter.clock_rate;
        log.samples.push_back(m);
    }

    const RangingScenario& s_;
    const RangingSettings& r_;
    detail::SightLines lines_;
    std::vector<Source> sources_;
};

}  // namespace

SimulatedRanges simulate_ranges(const RangingScenario& scenario, const TruthPath& path, const RangingSettings& settings) {
    check(settings);
    return Simulation(scenario, path, settings).run();
}

gnss::ObservationLog observations_of(const RangingLog& ranges, Duration shift) {
    gnss::ObservationLog out;
    out.version = 3.04;
    for (const RangeEpoch& e : ranges.epochs) {
        gnss::ObservationEpoch epoch{e.time + shift, false, out.observations.size(), 0};
        for (const RangeSample& m : ranges.of(e)) {
            const auto id = gnss::satellite_from(ranges.sources[m.source].name);
            if (!id) continue;
            gnss::SignalObservation o;
            o.satellite = *id;
            o.signal = {'1', 'C'};
            o.pseudorange = m.pseudorange;
            o.doppler = -m.range_rate * gnss::frequency_of(id->system, '1') / c;
            o.cn0 = m.cn0;
            if (id->system == gnss::System::Glonass) out.channels.of_slot[id->number] = 0;
            out.observations.push_back(o);
        }
        epoch.count = out.observations.size() - epoch.first;
        if (epoch.count > 0) out.epochs.push_back(epoch);
    }
    return out;
}

}  // namespace schuler::sim
