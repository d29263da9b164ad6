#include "schuler/sim/detail/sight_lines.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/constellation.h"
#include "schuler/gnss/ground_range.h"
#include "schuler/gnss/single_point.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/detail/require.h"

#include <algorithm>
#include <cmath>

namespace schuler::sim::detail {

namespace {

/// Rotates Earth-fixed axes of one instant to those of a time `tau` later.
Eigen::Vector3d turned(const Eigen::Vector3d& r, double rate, double tau) {
    const double angle = rate * tau, ca = std::cos(angle), sa = std::sin(angle);
    return {ca * r.x() + sa * r.y(), -sa * r.x() + ca * r.y(), r.z()};
}

void check(const RangingSettings& s) {
    const auto good = [](const sensor::RangeErrorModel& m) {
        return m.white >= 0.0 && m.correlated >= 0.0 && m.correlation_time > 0.0 && m.rate >= 0.0;
    };
    require(s.lever_arm_b.norm() < 200.0, "gnss.lever_arm_m", "is not a lever arm", "give metres forward, right, down");
    require(good(s.errors.satellite) && good(s.errors.station) && s.errors.network >= 0.0 && s.errors.network_time > 0.0,
            "ranges", "an error of the ranges is negative, or a correlation time not positive",
            "give one sigma in metres, times in seconds");
}

}  // namespace

SightLines::SightLines(const RangingScenario& scenario, const TruthPath& path, const RangingSettings& settings)
    : s_(scenario), path_(path), r_(settings), orbits_(settings.navigation), klobuchar_(gnss::klobuchar_of(settings.navigation)) {
    check(settings);
    for (const gnss::SatelliteId id : gnss::satellites_of(settings.navigation))
        transmitters_.push_back({gnss::name_of(id), id, {}, {}});
    for (const GroundStation& g : settings.stations)
        transmitters_.push_back({g.name, {}, earth::ecef_from_geodetic(scenario.earth.ellipsoid, g.position), g.position});
    for (const RangeFault& f : settings.faults) require_source("ranges.fault", f.source);
    for (const Blocking& b : settings.blocked)
        for (const std::string& name : b.sources)
            if (name != "stations") require_source("ranges.block", name);
    choose_throughout();
    choose_four();
}

void SightLines::require_source(const char* key, const std::string& name) const {
    if (std::ranges::find(transmitters_, name, &Transmitter::name) != transmitters_.end()) return;
    throw input_error('"' + name + "\" is neither a satellite nor a station of this scenario", {.file = {}, .key = key},
                      "give a name such as G05, or that of a station");
}

SightLines::Antenna SightLines::antenna(double t) const {
    const Kinematics k = path_.at(t);
    const Eigen::Matrix3d C_eb = earth::C_en(k.position.lat, k.position.lon) * math::dcm_from_rpy(k.rpy);
    Antenna a;
    a.position.r = earth::ecef_from_geodetic(s_.earth.ellipsoid, k.position).r + C_eb * r_.lever_arm_b;
    a.place = earth::geodetic_from_ecef(s_.earth.ellipsoid, a.position);
    a.up_e = -C_eb.col(2);
    return a;
}

std::optional<SightLine> SightLines::to(const Transmitter& transmitter, double t) const {
    const Antenna a = antenna(t);
    const double w = s_.earth.ellipsoid.w_ie;
    SightLine p;
    double tau = transmitter.satellite ? 0.07 : 0.0;
    for (int i = 0; i < 4; ++i) {
        if (transmitter.satellite) {
            const auto found = orbits_.at(*transmitter.satellite, {}, gps(t - tau));
            if (!found) return std::nullopt;
            p.transmitter = found->state;
        } else {
            p.transmitter.position = transmitter.station;
        }
        p.range = (a.position.r - turned(p.transmitter.position.r, w, tau)).norm();
        tau = p.range / gnss::speed_of_light;
    }
    p.direction = gnss::direction_to({turned(p.transmitter.position.r, w, tau)}, a.position, a.place);
    if (r_.atmosphere) {
        if (!transmitter.satellite) {
            p.range += gnss::ground_range_delay(transmitter.station_place, a.place, p.range);
        } else if (p.direction.elevation > 0.0) {
            p.range += gnss::troposphere_delay(gnss::saastamoinen_zenith(a.place, 0.7), gnss::Mapping::Niell, gps(t), a.place,
                                               p.direction.elevation);
            if (klobuchar_) p.range += gnss::klobuchar_delay(*klobuchar_, gps(t), a.place, p.direction);
        }
    }
    return p;
}

bool SightLines::allowed(const Transmitter& transmitter) const {
    return !transmitter.satellite || allowed_.empty() || std::ranges::find(allowed_, *transmitter.satellite) != allowed_.end();
}

bool SightLines::above_masks(const Transmitter& transmitter, const SightLine& line, double t) const {
    const Masks& m = r_.masks;
    if (!transmitter.satellite) return true;
    if (line.direction.elevation < m.elevation) return false;
    if (!m.terrain.empty()) {
        const double azimuth = math::wrap_2pi(line.direction.azimuth);
        double limit = m.terrain.back().elevation;
        for (const Masks::Sector& s : m.terrain)
            if (s.azimuth <= azimuth) limit = s.elevation;
        if (line.direction.elevation < limit) return false;
    }
    if (m.antenna) {
        const Antenna a = antenna(t);
        if ((line.transmitter.position.r - a.position.r).normalized().dot(a.up_e) < std::sin(*m.antenna)) return false;
    }
    return true;
}

bool SightLines::silent(const Transmitter& transmitter, double t) const {
    for (const Blocking& b : r_.blocked) {
        if (t < b.start || t >= b.start + b.duration) continue;
        if (b.sources.empty() && transmitter.satellite) return true;
        for (const std::string& name : b.sources)
            if (name == transmitter.name || (name == "stations" && !transmitter.satellite)) return true;
    }
    if (!transmitter.satellite) return false;
    const SatelliteLimit* limit = nullptr;
    for (const SatelliteLimit& l : r_.limits)
        if (l.start <= t && (limit == nullptr || l.start >= limit->start)) limit = &l;
    if (limit == nullptr) return false;
    std::vector<gnss::SatelliteId> kept;
    if (limit->keep > 4) {
        for (std::size_t i = 0; i < std::min(limit->keep, by_height_.size()); ++i) kept.push_back(by_height_[i]);
    } else {
        constexpr std::size_t pairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
        for (std::size_t i = 0; i < four_.size(); ++i) {
            const auto& pair = pairs[limit->variant % 6];
            if (limit->keep == 4 || (limit->keep == 3 && i != limit->variant % 4) ||
                (limit->keep == 2 && (i == pair[0] || i == pair[1])) || (limit->keep == 1 && i == limit->variant % 4))
                kept.push_back(four_[i]);
        }
    }
    return std::ranges::find(kept, *transmitter.satellite) == kept.end();
}

void SightLines::choose_throughout() {
    if (!r_.masks.throughout || r_.navigation.size() == 0) return;
    for (const Transmitter& transmitter : transmitters_) {
        if (!transmitter.satellite) continue;
        bool always = true;
        for (double t = 0.0; always && t <= s_.duration; t += 10.0) {
            const auto p = to(transmitter, t);
            always = p && p->direction.elevation > r_.masks.elevation;
        }
        if (always) allowed_.push_back(*transmitter.satellite);
    }
}

void SightLines::choose_four() {
    if (r_.limits.empty() || r_.navigation.size() == 0) return;
    const double t = 0.5 * s_.duration;
    const auto all = allowed_.empty() ? gnss::satellites_of(r_.navigation) : allowed_;
    const auto seen = gnss::satellites_in_view(orbits_, all, gps(t), antenna(t).position, r_.masks.elevation);
    for (const gnss::Sighting& s : seen) by_height_.push_back(s.satellite);
    for (const std::size_t i : gnss::best_four(seen)) four_.push_back(seen[i].satellite);
}

}  // namespace schuler::sim::detail
