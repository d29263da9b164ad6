#include "schuler/ppk/differential_ranges.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/ranges.h"
#include "schuler/math/quantile.h"
#include "schuler/ppk/differences.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

namespace schuler::ppk {
namespace {

using Key = std::pair<SatelliteId, std::uint8_t>;

constexpr double clock_step = 1000.0;  // m: receivers let their clocks jump by milliseconds, 300 km

/// Clock of the base, m: its codes' when it begins, continued by its phases, whose sum does not jump as satellites come and go.
class BaseClock {
public:
    [[nodiscard]] double at(const BaseEpoch& base) {
        std::vector<double> codes, steps;
        std::map<Key, std::pair<int, double>> phases;
        for (const BaseSatellite& s : base.satellites) {
            for (std::size_t k = 0; k < most_signals; ++k) {
                const BaseSignal& signal = s.signals[k];
                if (k == 0 && std::isfinite(signal.code)) codes.push_back(signal.code);
                if (!std::isfinite(signal.phase) || signal.arc == 0) continue;
                const Key key{s.id, static_cast<std::uint8_t>(k)};
                phases[key] = {signal.arc, signal.phase};
                const auto before = phases_.find(key);
                if (before != phases_.end() && before->second.first == signal.arc)
                    steps.push_back(signal.phase - before->second.second);
            }
        }
        phases_ = std::move(phases);
        if (!steps.empty()) clock_ += math::median(std::move(steps));
        else known_ = false;
        if (codes.empty()) return clock_;
        constexpr double wrong = 30.0;  // m
        const double by_codes = math::median(std::move(codes));
        if (!known_ || std::abs(clock_ - by_codes) > wrong) clock_ = by_codes;
        known_ = true;
        return clock_;
    }

private:
    bool known_ = false;
    double clock_ = 0;
    std::map<Key, std::pair<int, double>> phases_;
};

/// Arcs common to both receivers, and by how much their phases are shifted.
class CommonArcs {
public:
    /// The median change of phase minus code since the last epoch: clock steps that only one of them shows.
    void follow(const std::vector<Difference>& differences) {
        std::vector<double> changes;
        for (const Difference& d : differences) {
            const auto it = arcs_.find(key_of(d));
            if (it != arcs_.end() && it->second.rover == d.rover_arc && it->second.base == d.base_arc && std::isfinite(d.code))
                changes.push_back(d.phase - d.code - it->second.apart);
        }
        const double change = changes.empty() ? 0.0 : math::median(std::move(changes));
        if (std::abs(change) > clock_step) shift_ -= change;
        for (const Difference& d : differences) {
            Arc& arc = arcs_[key_of(d)];
            const double apart = d.phase - d.code;
            if (arc.number == 0 || arc.rover != d.rover_arc || arc.base != d.base_arc) {
                const int number = arc.number + 1;
                arc = {number, d.rover_arc, d.base_arc, not_given, 0.0};
                if (std::isfinite(apart)) arc.cycles = std::round((apart + shift_) / d.wavelength) * d.wavelength;
            }
            if (std::isfinite(apart)) arc.apart = apart;
        }
    }
    [[nodiscard]] int number(const Difference& d) const { return arcs_.at(key_of(d)).number; }
    /// m, to be added to the phase.
    [[nodiscard]] double shift(const Difference& d) const { return shift_ - arcs_.at(key_of(d)).cycles; }

private:
    struct Arc {
        int number = 0, rover = 0, base = 0;
        double apart = not_given;  ///< phase minus code, m
        double cycles = 0;         ///< m
    };
    static Key key_of(const Difference& d) { return {d.id, d.slot}; }

    double shift_ = 0;
    std::map<Key, Arc> arcs_;
};

/// Factor on a variance for the whole log, at least one: nine tenths of the epochs show no more.
double usual_scale(const std::vector<EpochSolution>& solutions, double EpochSolution::*scale) {
    std::vector<double> values;
    for (const EpochSolution& s : solutions)
        if (s.quality == Quality::Fixed || s.quality == Quality::Float) values.push_back(s.*scale);
    return values.empty() ? 1.0 : std::max(1.0, math::quantile(std::move(values), 0.9));
}

}  // namespace

RangingLog differential_ranges(const std::vector<TrackedEpoch>& rover, const BaseStation& station, const SignalPlan& plan,
                               const std::vector<EpochSolution>& solutions, const Settings& settings) {
    RangingLog log;
    const double of_codes = usual_scale(solutions, &EpochSolution::code_scale),
                 of_phases = usual_scale(solutions, &EpochSolution::phase_scale);
    BaseClock base_clock;
    CommonArcs arcs;
    for (std::size_t i = 0; i < rover.size(); ++i) {
        const TrackedEpoch& epoch = rover[i];
        const auto base = station.at(epoch.tag);
        if (!base) continue;
        const bool solved = solutions[i].quality != Quality::None;
        const Ecef& position = solved ? solutions[i].position : epoch.position;
        const Geodetic geodetic = earth::geodetic_from_ecef(earth::wgs84, position);
        const double clock = base_clock.at(*base), vertical = solutions[i].vertical_ionosphere;
        const auto differences = single_differences(epoch, *base, station, plan, position, settings, false);
        arcs.follow(differences);
        RangeEpoch out{epoch.tag, log.samples.size(), 0, log.carriers.size(), 0};
        for (const TrackedSatellite& s : epoch.satellites) {
            const auto of_satellite = [&](const Difference& d) { return d.id == s.id; };
            const auto first = std::ranges::find_if(differences, of_satellite);
            if (first == differences.end()) continue;
            const double modelled = line_to(s, position, geodetic).range - s.clock + clock;
            RangeSample m;
            m.source = log.source(gnss::name_of(s.id), false);
            m.differential = true;
            m.pseudorange = first->code + modelled - first->vertical_factor() * vertical;
            m.range_rate = s.signals[first->slot].doppler;
            m.cn0 = s.signals[first->slot].cn0;
            m.tx = s.position;
            m.tx_velocity = s.velocity;
            m.tx_clock = s.clock / gnss::speed_of_light;
            m.tx_clock_rate = s.clock_rate / gnss::speed_of_light;
            m.frequency = gnss::speed_of_light / first->wavelength;
            m.variance = first->left;
            m.noise = std::sqrt(of_codes * std::max(first->code_variance - m.variance, 0.0)) /
                      (settings.code_sigma * gnss::noise_factor(first->elevation, m.cn0));
            log.samples.push_back(m);
            ++out.count;
            for (auto d = first; d != differences.end() && of_satellite(*d); ++d) {
                CarrierSample c;
                c.source = m.source;
                c.carrier = d->slot;
                c.arc = arcs.number(*d);
                c.phase = d->phase + modelled + arcs.shift(*d) + d->vertical_factor() * vertical;
                c.wavelength = d->wavelength;
                c.whole = d->whole;
                c.halves = d->halves;
                c.elevation = d->elevation;
                c.variance = of_phases * (d->phase_variance - d->left) + d->left;
                c.repeated = d->repeated;
                log.carriers.push_back(c);
                ++out.carriers;
            }
        }
        std::ranges::stable_sort(log.carriers.begin() + static_cast<std::ptrdiff_t>(out.first_carrier), log.carriers.end(),
                                 std::greater{}, &CarrierSample::elevation);  // the highest first, if there are more than states
        constexpr std::size_t least = 4;
        if (out.count >= least) {
            log.epochs.push_back(out);
        } else {
            log.samples.resize(out.first);
            log.carriers.resize(out.first_carrier);
        }
    }
    return log;
}

}  // namespace schuler::ppk
