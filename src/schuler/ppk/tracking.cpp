#include "schuler/ppk/tracking.h"

#include "schuler/earth/ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

namespace schuler::ppk {
namespace {

using gnss::ObservationLog;
using gnss::SignalObservation;
using gnss::System;

/// Carriers in order of preference.
std::string_view bands_of(System system) {
    switch (system) {
        case System::Glonass: return "12";
        case System::Galileo: return "15786";
        case System::BeiDou: return "21765";
        case System::Navic: return "5";
        default: return "125";
    }
}

bool has_phase(const SignalObservation& o) { return std::isfinite(o.phase) && o.phase != 0.0; }

/// Number of phases of each signal of each satellite.
using Counts = std::map<std::pair<SatelliteId, gnss::Signal>, std::size_t>;
Counts count_phases(const ObservationLog& log, const gnss::RangeSettings& settings) {
    Counts counts;
    for (const SignalObservation& o : log.observations)
        if (has_phase(o) && settings.systems[static_cast<std::size_t>(o.satellite.system)]) ++counts[{o.satellite, o.signal}];
    return counts;
}

struct Mode {
    SignalPair pair;
    std::size_t count = 0;
};
/// The best tracking modes of a satellite's carrier: a common one, else the most frequent of each.
Mode best_mode(const Counts& rover, const Counts& base, SatelliteId id, char band) {
    Mode common, apart;
    std::size_t most_rover = 0, most_base = 0;
    const auto first = [&](const Counts& c) { return c.lower_bound({id, {band, '\0'}}); };
    const auto in_band = [&](const Counts& c, Counts::const_iterator it) {
        return it != c.end() && it->first.first == id && it->first.second.band == band;
    };
    for (auto it = first(rover); in_band(rover, it); ++it) {
        const auto other = base.find(it->first);
        const std::size_t both = other == base.end() ? 0 : std::min(it->second, other->second);
        if (both > common.count) common = {{it->first.second, it->first.second}, both};
        if (it->second > most_rover) {
            most_rover = it->second;
            apart.pair.rover = it->first.second;
        }
    }
    for (auto it = first(base); in_band(base, it); ++it) {
        if (it->second <= most_base) continue;
        most_base = it->second;
        apart.pair.base = it->first.second;
    }
    apart.count = std::min(most_rover, most_base);
    // a common mode is preferred even if another is more frequent
    return 2 * common.count >= apart.count ? common : apart;
}

const SignalObservation* find(std::span<const SignalObservation> of_satellite, gnss::Signal signal) {
    const auto it = std::ranges::find(of_satellite, signal, &SignalObservation::signal);
    return it == of_satellite.end() ? nullptr : &*it;
}

bool is_code(double pseudorange) { return pseudorange > 1e6 && pseudorange < 1e9; }

/// One satellite of an epoch; empty without a code, an ephemeris or a phase.
std::optional<TrackedSatellite> tracked_satellite(std::span<const SignalObservation> of_satellite,
                                                  std::span<const SignalPair> pairs, Side side, Time tag,
                                                  const gnss::SatelliteSource& source, const ObservationLog& log,
                                                  const gnss::RangeSettings& settings) {
    TrackedSatellite out;
    out.id = of_satellite.front().satellite;
    const auto with_code = std::ranges::find_if(of_satellite, [](const SignalObservation& o) { return is_code(o.pseudorange); });
    if (with_code == of_satellite.end()) return std::nullopt;
    // the time of transmission by the satellite's clock, independent of the receiver's, then in GPS time
    const Time by_clock = tag - Duration::from_seconds(with_code->pseudorange / gnss::speed_of_light);
    const auto first = source.at(out.id, with_code->signal, by_clock);
    if (!first) return std::nullopt;
    out.transmit = by_clock - Duration::from_seconds(first->state.clock);
    const auto t = source.at(out.id, with_code->signal, out.transmit);
    if (!t) return std::nullopt;
    out.position = t->state.position;
    out.velocity = t->state.velocity;
    out.clock = gnss::speed_of_light * t->state.clock;
    out.clock_rate = gnss::speed_of_light * t->state.clock_rate;
    out.variance = t->state.variance;
    int channel = t->channel;
    if (out.id.system == System::Glonass && log.channels.of_slot[out.id.number] != gnss::unknown_channel)
        channel = log.channels.of_slot[out.id.number];
    bool any = false;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const SignalObservation* o = find(of_satellite, side == Side::Rover ? pairs[k].rover : pairs[k].base);
        if (o == nullptr || o->cn0 < settings.least_cn0) continue;
        TrackedSignal& s = out.signals[k];
        const double frequency = gnss::frequency_of(out.id.system, o->signal.band, channel);
        if (!(frequency > 0.0)) continue;
        s.wavelength = gnss::speed_of_light / frequency;
        s.cn0 = o->cn0;
        if (is_code(o->pseudorange)) s.code = o->pseudorange;
        if (std::isfinite(o->doppler)) s.doppler = -o->doppler * s.wavelength;
        if (!has_phase(*o)) continue;
        s.phase = o->phase * s.wavelength;
        s.lost = (o->loss_of_lock & 1U) != 0;
        s.half_cycle = (o->loss_of_lock & 2U) != 0;
        any = true;
    }
    return any ? std::optional(out) : std::nullopt;
}

void refer_to_reference_point(TrackedSatellite& satellite, const gnss::Antenna& antenna) {
    for (TrackedSignal& s : satellite.signals) {
        if (!(s.wavelength > 0.0)) continue;
        const double added = antenna.to_reference_point(gnss::speed_of_light / s.wavelength, satellite.direction);
        s.code += added;
        s.phase += added;
    }
}

}  // namespace

std::size_t SignalPlan::satellites() const {
    return static_cast<std::size_t>(std::ranges::count_if(of, [](const auto& pairs) { return !pairs.empty(); }));
}

SignalPlan common_signals(const ObservationLog& rover, const ObservationLog& base, const gnss::RangeSettings& settings,
                          std::size_t frequencies) {
    const Counts of_rover = count_phases(rover, settings), of_base = count_phases(base, settings);
    SignalPlan plan;
    for (auto it = of_rover.begin(); it != of_rover.end();) {
        const SatelliteId id = it->first.first;
        std::vector<Mode> found;
        std::size_t most = 0;
        for (const char band : bands_of(id.system)) {
            const Mode m = best_mode(of_rover, of_base, id, band);
            if (m.count == 0) continue;
            found.push_back(m);
            most = std::max(most, m.count);
        }
        for (const Mode& m : found) {
            auto& pairs = plan.of[gnss::index_of(id)];
            // a carrier that is present only occasionally does not displace another
            if (pairs.size() < std::min(frequencies, most_signals) && 2 * m.count >= most) pairs.push_back(m.pair);
        }
        while (it != of_rover.end() && it->first.first == id) ++it;
    }
    return plan;
}

Line line_to(const TrackedSatellite& s, const Ecef& receiver, const Geodetic& geodetic) {
    const Eigen::Vector3d& from = s.position.r;
    const double w_c = earth::wgs84.w_ie / gnss::speed_of_light, distance = (receiver.r - from).norm();
    Line out;
    out.range = distance + w_c * (from.x() * receiver.r.y() - from.y() * receiver.r.x());
    const double angle = w_c * distance;
    const Ecef turned{{from.x() + angle * from.y(), from.y() - angle * from.x(), from.z()}};
    out.towards = (receiver.r - turned.r).normalized();
    out.direction = gnss::direction_to(turned, receiver, geodetic);
    return out;
}

std::vector<TrackedEpoch> tracked(const ObservationLog& log, const Receiver& receiver, const SignalPlan& plan,
                                  const gnss::SatelliteSource& source, gnss::SinglePoint& solver,
                                  const gnss::RangeSettings& settings) {
    std::vector<TrackedEpoch> out;
    out.reserve(log.epochs.size());
    std::optional<Ecef> last = receiver.fixed;
    Duration clock_error{};
    for (const gnss::ObservationEpoch& e : log.epochs) {
        const auto observations = log.of(e);
        TrackedEpoch epoch;
        epoch.tag = e.time;
        if (!receiver.fixed) {
            epoch.single = solver.solve(observations, e.time, log.channels);
            epoch.single.satellites = {};
            epoch.placed = epoch.single.status == gnss::SinglePointStatus::Solved;
            if (epoch.placed) {
                last = epoch.single.position;
                clock_error = e.time - epoch.single.time;
            }
        }
        epoch.time = e.time - clock_error;
        if (!last) continue;  // the position of the receiver is unknown
        epoch.position = *last;
        const Geodetic geodetic = earth::geodetic_from_ecef(earth::wgs84, *last);
        for (std::size_t first = 0, end = 0; first < observations.size(); first = end) {
            const SatelliteId id = observations[first].satellite;
            while (end < observations.size() && observations[end].satellite == id) ++end;
            const auto& pairs = plan.of[gnss::index_of(id)];
            if (pairs.empty()) continue;
            auto satellite =
                tracked_satellite(observations.subspan(first, end - first), pairs, receiver.side, e.time, source, log, settings);
            if (!satellite) continue;
            satellite->direction = line_to(*satellite, *last, geodetic).direction;
            if (receiver.antenna != nullptr) refer_to_reference_point(*satellite, *receiver.antenna);
            if (e.power_failure)
                for (TrackedSignal& s : satellite->signals) s.lost = true;
            if (satellite->direction.elevation >= settings.elevation_mask) epoch.satellites.push_back(*satellite);
        }
        out.push_back(std::move(epoch));
    }
    return out;
}

}  // namespace schuler::ppk
