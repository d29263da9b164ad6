#include "schuler/gnss/satellite_source.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>

namespace schuler::gnss {
namespace {

std::int64_t longest_age(const KeplerEphemeris& k) {
    constexpr std::int64_t hour = 3'600'000'000'000;
    if (k.satellite.system == System::Galileo) return 4 * hour;
    if (k.satellite.system == System::BeiDou) return 6 * hour;
    return std::max(2 * hour, Duration::from_seconds(0.5 * k.fit_interval).ns);
}
std::int64_t longest_age(const GlonassEphemeris&) { return 1'800'000'000'000; }
std::int64_t longest_age(const SbasEphemeris&) { return 360'000'000'000; }

/// Among ephemerides of one time the one with the higher rank is used.
int rank(const KeplerEphemeris& k) { return k.message == NavMessage::Fnav ? 0 : 1; }
template <class Other>
int rank(const Other&) {
    return 0;
}

template <class Ephemeris>
void sort(std::vector<Ephemeris>& all) {
    std::ranges::stable_sort(
        all, {}, [](const Ephemeris& e) { return std::tuple(index_of(e.satellite), e.toe, rank(e), e.transmission); });
}

/// Of two kinds of message with other group delays the common one is used throughout, so that ranges do not step.
bool second_choice(const KeplerEphemeris& k) { return k.message == NavMessage::Cnav; }
template <class Other>
bool second_choice(const Other&) {
    return false;
}

template <class Ephemeris>
const Ephemeris* nearest(const std::vector<Ephemeris>& all, std::size_t first, std::size_t last, Time t) {
    const Ephemeris* best = nullptr;
    std::int64_t apart = 0;
    for (std::size_t i = first; i < last; ++i) {
        const std::int64_t d = std::abs((t - all[i].toe).ns);
        if (d > longest_age(all[i])) continue;
        const bool second = second_choice(all[i]), before = best != nullptr && second_choice(*best);
        if (best == nullptr || (before && !second) || (before == second && d <= apart)) {
            best = &all[i];
            apart = d;
        }
    }
    return best;
}

/// If orbits of two messages differ at their midpoint by more than their accuracies explain (one pair in a thousand), they are
/// not of one satellite. A satellite that was manoeuvred between them is marked unhealthy meanwhile.
template <class Ephemeris>
bool contradict(const Ephemeris& a, const Ephemeris& b) {
    constexpr double sphere = 4.03;      // of a three-dimensional normal distribution: one in a thousand is outside
    constexpr double least_sigma = 4.0;  // m, at half of the maximum age
    const Time middle = a.toe + Duration{(b.toe - a.toe).ns / 2};
    const SatelliteState one = satellite_state(a, middle), other = satellite_state(b, middle);
    const double variance =
        std::max(one.variance, least_sigma * least_sigma) + std::max(other.variance, least_sigma * least_sigma);
    return (one.position.r - other.position.r).norm() > sphere * std::sqrt(variance);
}

/// Largest separation of two messages compared at their midpoint. BeiDou's are renewed hourly; their accuracy after three hours is unspecified.
template <class Ephemeris>
std::int64_t longest_comparison(const Ephemeris& e) {
    constexpr std::int64_t two_hours = 7'200'000'000'000;
    return e.satellite.system == System::BeiDou ? two_hours : longest_age(e);
}

/// Excludes from all, sorted by satellite and time, those that contradict a neighbour no older than half of the validity of either, and
/// all of a satellite if most do: a single epoch does not reveal it if several satellites are affected. Adds the satellites concerned.
template <class Ephemeris>
void leave_out_contradictions(std::vector<Ephemeris>& all, std::vector<SatelliteId>& whose) {
    std::size_t kept = 0;
    for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
        while (last < all.size() && all[last].satellite == all[first].satellite) ++last;
        std::vector<bool> wrong(last - first, false);
        std::size_t pairs = 0, contradictions = 0;
        for (std::size_t i = first + 1; i < last; ++i) {
            const Ephemeris &a = all[i - 1], &b = all[i];
            if (a.health != 0 || b.health != 0 || a.toe == b.toe ||
                (b.toe - a.toe).ns > std::min(longest_comparison(a), longest_comparison(b)))
                continue;
            ++pairs;
            if (!contradict(a, b)) continue;
            ++contradictions;
            wrong[i - 1 - first] = wrong[i - first] = true;
        }
        const bool none = 2 * contradictions > pairs;
        if (contradictions > 0) whose.push_back(all[first].satellite);
        for (std::size_t i = first; i < last; ++i)
            if (!none && !wrong[i - first]) all[kept++] = all[i];
    }
    all.resize(kept);
}

bool is_healthy(const KeplerEphemeris& k) {
    // bit 0 of QZSS health refers to signals not used here
    return (k.satellite.system == System::Qzss ? k.health & ~1 : k.health) == 0;
}

}  // namespace

BroadcastSource::BroadcastSource(Navigation navigation) : navigation_(std::move(navigation)) {
    const auto index = [&](auto& all) {
        sort(all);
        if constexpr (!std::is_same_v<std::decay_t<decltype(all)>, std::vector<SbasEphemeris>>)
            leave_out_contradictions(all, contradicting_);
        for (std::size_t i = 0; i < all.size(); ++i) {
            Range& r = ranges_[index_of(all[i].satellite)];
            if (r.last == 0) r.first = i;
            r.last = i + 1;
        }
    };
    index(navigation_.kepler);
    index(navigation_.glonass);
    index(navigation_.sbas);
}

const KeplerEphemeris* BroadcastSource::kepler(SatelliteId s, Time t) const {
    if (s.system == System::Glonass || s.system == System::Sbas) return nullptr;
    const Range r = ranges_[index_of(s)];
    return nearest(navigation_.kepler, r.first, r.last, t);
}

const GlonassEphemeris* BroadcastSource::glonass(SatelliteId s, Time t) const {
    const Range r = ranges_[index_of(s)];
    return s.system == System::Glonass ? nearest(navigation_.glonass, r.first, r.last, t) : nullptr;
}

const SbasEphemeris* BroadcastSource::sbas(SatelliteId s, Time t) const {
    const Range r = ranges_[index_of(s)];
    return s.system == System::Sbas ? nearest(navigation_.sbas, r.first, r.last, t) : nullptr;
}

std::optional<Transmitter> BroadcastSource::at(SatelliteId s, Signal signal, Time t) const {
    if (const GlonassEphemeris* g = glonass(s, t)) {
        if (g->health != 0) return std::nullopt;
        return Transmitter{satellite_state(*g, t), gnss::group_delay(*g, signal), g->channel};
    }
    if (const SbasEphemeris* g = sbas(s, t)) {
        if ((g->health & 1) != 0) return std::nullopt;  // bit 0: ranging off
        return Transmitter{satellite_state(*g, t), 0.0, 0};
    }
    const KeplerEphemeris* k = kepler(s, t);
    if (k == nullptr || !is_healthy(*k)) return std::nullopt;
    return Transmitter{satellite_state(*k, t), gnss::group_delay(*k, signal), 0};
}

namespace {

constexpr std::size_t nodes_used = 11;

/// Lagrange's polynomial through nodes rotated back to the axes at t.
Eigen::Vector3d interpolated(const PreciseSource::Node* nodes, Time t) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < nodes_used; ++i) {
        double weight = 1.0;
        for (std::size_t j = 0; j < nodes_used; ++j) {
            if (j != i) weight *= (t - nodes[j].time).seconds() / (nodes[i].time - nodes[j].time).seconds();
        }
        const double angle = gps_earth_rate * (nodes[i].time - t).seconds(), s = std::sin(angle), c = std::cos(angle);
        const Eigen::Vector3d& r = nodes[i].position;
        sum += weight * Eigen::Vector3d(c * r.x() - s * r.y(), s * r.x() + c * r.y(), r.z());
    }
    return sum;
}

}  // namespace

std::optional<Transmitter> PreciseSource::at(SatelliteId s, Signal signal, Time t) const {
    const std::vector<Node>& nodes = nodes_[index_of(s)];
    if (nodes.size() < nodes_used || t < nodes.front().time || t > nodes.back().time) return std::nullopt;
    const auto after = std::ranges::upper_bound(nodes, t, {}, &Node::time);
    const auto place = static_cast<std::size_t>(after - nodes.begin());
    const std::size_t first = std::min(place - std::min(place, nodes_used / 2 + 1), nodes.size() - nodes_used);
    const std::size_t left = std::min(place, nodes.size() - 1) - 1;
    // no interpolation across a gap: its width is compared with the spacing of the first epochs
    const Duration spacing = nodes[1].time - nodes[0].time;
    if ((nodes[first + nodes_used - 1].time - nodes[first].time).ns > 2 * static_cast<std::int64_t>(nodes_used) * spacing.ns)
        return std::nullopt;
    const Node &a = nodes[left], &b = nodes[left + 1];
    const double span = (b.time - a.time).seconds(), w = (t - a.time).seconds() / span;
    SatelliteState out;
    const Duration step{500'000'000};
    out.position.r = interpolated(&nodes[first], t);
    out.velocity = interpolated(&nodes[first], t + step) - interpolated(&nodes[first], t - step);  // over one second
    out.clock = (1.0 - w) * a.clock + w * b.clock;
    out.clock_rate = (b.clock - a.clock) / span;
    if (!std::isfinite(out.clock)) return std::nullopt;
    // SP3 satellite clocks exclude the periodic relativistic effect, -2 r.v/c^2
    const Eigen::Vector3d inertial =
        out.velocity + gps_earth_rate * Eigen::Vector3d(-out.position.r.y(), out.position.r.x(), 0.0);
    out.clock -= 2.0 * out.position.r.dot(inertial) / (speed_of_light * speed_of_light);
    // Phase centres lie 0.5 to 3 m from the centres of mass, by the type of the satellite.
    constexpr double sigma = 0.05, centre_of_mass = 1.5;  // m
    const Antenna* antenna = antennas_.of_satellite(s, t);
    if (antenna != nullptr)
        out.position.r += satellite_phase_centre(*antenna, frequency_of(s.system, signal.band), out.position, t);
    out.variance = sigma * sigma + (antenna != nullptr ? 0.0 : centre_of_mass * centre_of_mass);
    return Transmitter{out, 0.0, 0};
}

}  // namespace schuler::gnss
