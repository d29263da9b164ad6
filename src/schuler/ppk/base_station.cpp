#include "schuler/ppk/base_station.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/ppk/air_delay.h"

#include <algorithm>
#include <cmath>

namespace schuler::ppk {
namespace {

/// Stamps that differ by less count as simultaneous: satellite clock variations meanwhile are below a thousandth of a wavelength.
constexpr double same_instant = 0.006;  // s

const BaseSatellite* find(const std::vector<BaseSatellite>& satellites, SatelliteId id) {
    const auto it = std::ranges::lower_bound(satellites, id, {}, &BaseSatellite::id);
    return it != satellites.end() && it->id == id ? &*it : nullptr;
}

}  // namespace

BaseStation::BaseStation(const std::vector<TrackedEpoch>& epochs, const Ecef& position, const AirModel& air,
                         const BaseSettings& settings)
    : position_(position), geodetic_(earth::geodetic_from_ecef(earth::wgs84, position)), settings_(settings) {
    nodes_.reserve(epochs.size());
    for (const TrackedEpoch& e : epochs) {
        Node& node = nodes_.emplace_back();
        node.tag = e.tag;
        for (const TrackedSatellite& s : e.satellites) {
            BaseSatellite& b = node.satellites.emplace_back();
            b.id = s.id;
            const Line line = line_to(s, position_, geodetic_);
            b.direction = line.direction;
            const AirDelay delay = air_delay(air, s, geodetic_, line.direction);
            const double modelled = line.range - s.clock + delay.troposphere;
            for (std::size_t k = 0; k < most_signals; ++k) {
                const TrackedSignal& t = s.signals[k];
                const double ionosphere = t.wavelength > 0.0 ? ionosphere_factor(t.wavelength) * delay.ionosphere : 0.0;
                BaseSignal& out = b.signals[k];
                out.code = t.code - modelled - ionosphere;
                out.phase = t.phase - modelled + ionosphere;
                out.cn0 = t.cn0;
                out.arc = t.arc;
                out.half_cycle = t.half_cycle;
                out.jumped = t.jumped;
            }
        }
        std::ranges::sort(node.satellites, {}, &BaseSatellite::id);
    }
}

BaseEpoch BaseStation::between(const Node& a, const Node& b, Time tag) const {
    const double before = (tag - a.tag).seconds(), after = (b.tag - tag).seconds(), span = before + after;
    const double wb = before / span, wa = after / span;
    BaseEpoch out;
    out.age = std::min(before, after);
    out.repeated = true;
    out.variance = settings_.clock_walk * settings_.clock_walk * before * after / span;  // of a random walk with known ends
    for (const BaseSatellite& s : a.satellites) {
        const BaseSatellite* other = find(b.satellites, s.id);
        if (other == nullptr) continue;  // weights must be the same for all, so that the base's own clock cancels
        BaseSatellite merged = s;
        for (std::size_t k = 0; k < most_signals; ++k) {
            BaseSignal& m = merged.signals[k];
            const BaseSignal& o = other->signals[k];
            m.code = wa * m.code + wb * o.code;
            m.phase = m.arc == o.arc && m.arc != 0 ? wa * m.phase + wb * o.phase : not_given;
            m.code_factor = m.phase_factor = wa * wa + wb * wb;
            m.half_cycle = m.half_cycle || o.half_cycle;
            m.cn0 = std::min(m.cn0, o.cn0);
        }
        out.satellites.push_back(merged);
    }
    return out;
}

std::optional<BaseEpoch> BaseStation::at(Time tag) const {
    const auto after = std::ranges::lower_bound(nodes_, tag, {}, &Node::tag);
    const Node* b = after != nodes_.end() ? &*after : nullptr;
    const Node* a = after != nodes_.begin() ? &*(after - 1) : nullptr;
    const auto apart = [&](const Node* n) { return n == nullptr ? 1e12 : std::abs((n->tag - tag).seconds()); };
    const Node* nearest = apart(a) < apart(b) ? a : b;
    if (nearest == nullptr) return std::nullopt;
    constexpr double rounding = 1e-6;  // s
    const double age = apart(nearest);
    if (age > same_instant && a != nullptr && b != nullptr && (b->tag - a->tag).seconds() <= settings_.longest_span + rounding)
        return between(*a, *b, tag);
    if (age > settings_.longest_age + rounding) return std::nullopt;
    return BaseEpoch{nearest->satellites, age, age > same_instant,
                     age > same_instant ? settings_.clock_walk * settings_.clock_walk * age : 0.0};
}

}  // namespace schuler::ppk
