#include "schuler/sim/ranging.h"

#include "schuler/core/error.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/constellation.h"
#include "schuler/gnss/ground_range.h"
#include "schuler/gnss/single_point.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/detail/require.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace schuler::sim {
namespace {

constexpr double c = gnss::speed_of_light;

using detail::require;

void check(const RangingSettings& s) {
    const auto good = [](const sensor::RangeErrorModel& m) {
        return m.white >= 0.0 && m.correlated >= 0.0 && m.correlation_time > 0.0 && m.rate >= 0.0;
    };
    require(s.rate > 0.0 && s.rate <= 1000.0, "ranges.rate_hz", "is not a rate", "give a positive number of Hz");
    require(s.lever_arm_b.norm() < 200.0, "gnss.lever_arm_m", "is not a lever arm", "give metres forward, right, down");
    require(good(s.errors.satellite) && good(s.errors.station) && s.errors.network >= 0.0 && s.errors.network_time > 0.0, "ranges",
            "an error of the ranges is negative, or a correlation time not positive", "give one sigma in metres, times in seconds");
    require(s.multipath.period > 0.0, "ranges.multipath_period_s", "is not positive", "give seconds");
}

/// The antenna in Earth-fixed axes, with what masks need.
struct Antenna {
    Ecef position;
    Geodetic place;
    Eigen::Vector3d up_e;   ///< out of the antenna's plane
};

class Receiver {
public:
    Receiver(const RangingScenario& s, const TruthPath& path, const RangingSettings& r) : s_(s), path_(path), r_(r) {}

    [[nodiscard]] Antenna at(double t) const {
        const Kinematics k = path_.at(t);
        const Eigen::Matrix3d C_eb = earth::C_en(k.position.lat, k.position.lon) * math::dcm_from_rpy(k.rpy);
        Antenna a;
        a.position.r = earth::ecef_from_geodetic(s_.earth.ellipsoid, k.position).r + C_eb * r_.lever_arm_b;
        a.place = earth::geodetic_from_ecef(s_.earth.ellipsoid, a.position);
        a.up_e = -C_eb.col(2);
        return a;
    }

private:
    const RangingScenario& s_;
    const TruthPath& path_;
    const RangingSettings& r_;
};

/// Turns Earth-fixed axes of one instant to those of a time `tau` later.
Eigen::Vector3d turned(const Eigen::Vector3d& r, double rate, double tau) {
    const double angle = rate * tau, ca = std::cos(angle), sa = std::sin(angle);
    return {ca * r.x() + sa * r.y(), -sa * r.x() + ca * r.y(), r.z()};
}

/// A geometric range with the transmitter that belongs to it.
struct Path {
    double range = 0;   ///< m, light time included, delays of the atmosphere too
    gnss::SatelliteState transmitter;
    gnss::Direction direction;
};

/// One source of ranges with its own slow error and streams.
struct Source {
    std::string name;
    std::optional<gnss::SatelliteId> satellite;
    Ecef station;
    Geodetic station_place;
    sensor::RangeErrorModel errors;
    math::Random white, slow, rate;
    double correlated = 0.0, phase = 0.0;

    Source(std::string name_, const sensor::RangeErrorModel& model, std::uint64_t seed)
        : name(std::move(name_)), errors(model), white(seed, "ranges.white." + name), slow(seed, "ranges.slow." + name),
          rate(seed, "ranges.rate." + name) {
        correlated = errors.correlated * slow.normal();
        phase = 2.0 * std::numbers::pi * slow.uniform();
    }
    void advance(double dt) {
        const double kept = std::exp(-dt / errors.correlation_time);
        correlated = kept * correlated + std::sqrt(1.0 - kept * kept) * errors.correlated * slow.normal();
    }
};

class Simulation {
public:
    Simulation(const RangingScenario& s, const TruthPath& path, const RangingSettings& r)
        : s_(s), r_(r), receiver_(s, path, r), orbits_(r.navigation), klobuchar_(gnss::klobuchar_of(r.navigation)) {
        for (const gnss::SatelliteId id : gnss::satellites_of(r.navigation)) {
            Source& source = sources_.emplace_back(gnss::name_of(id), r.errors.satellite, s.seed);
            source.satellite = id;
        }
        for (const GroundStation& g : r.stations) {
            Source& source = sources_.emplace_back(g.name, r.errors.station, s.seed);
            source.station = earth::ecef_from_geodetic(s.earth.ellipsoid, g.position);
            source.station_place = g.position;
        }
        choose_throughout();
        choose_four();
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
    [[nodiscard]] Time gps(double t) const { return s_.gps + Duration::from_seconds(t); }

    /// Range from a source to the antenna at t seconds of true time; nothing where there is no such satellite.
    [[nodiscard]] std::optional<Path> path_to(const Source& source, double t) const {
        const Antenna a = receiver_.at(t);
        const double w = s_.earth.ellipsoid.w_ie;
        Path p;
        double tau = source.satellite ? 0.07 : 0.0;
        for (int i = 0; i < 4; ++i) {
            if (source.satellite) {
                const auto found = orbits_.at(*source.satellite, {}, gps(t - tau));
                if (!found) return std::nullopt;
                p.transmitter = found->state;
            } else {
                p.transmitter.position = source.station;
            }
            p.range = (a.position.r - turned(p.transmitter.position.r, w, tau)).norm();
            tau = p.range / c;
        }
        p.direction = gnss::direction_to({turned(p.transmitter.position.r, w, tau)}, a.position, a.place);
        if (r_.atmosphere) {
            if (!source.satellite) {
                p.range += gnss::ground_range_delay(source.station_place, a.place, p.range);
            } else if (p.direction.elevation > 0.0) {
                p.range += gnss::troposphere_delay(gnss::saastamoinen_zenith(a.place, 0.7), gnss::Mapping::Niell, gps(t), a.place,
                                                   p.direction.elevation);
                if (klobuchar_) p.range += gnss::klobuchar_delay(*klobuchar_, gps(t), a.place, p.direction);
            }
        }
        return p;
    }

    [[nodiscard]] bool above_masks(const Path& p, double t) const {
        const Masks& m = r_.masks;
        if (p.direction.elevation < m.elevation) return false;
        if (!m.terrain.empty()) {
            const double azimuth = math::wrap_2pi(p.direction.azimuth);
            double limit = m.terrain.back().elevation;
            for (const Masks::Sector& s : m.terrain)
                if (s.azimuth <= azimuth) limit = s.elevation;
            if (p.direction.elevation < limit) return false;
        }
        if (m.antenna) {
            const Antenna a = receiver_.at(t);
            if ((p.transmitter.position.r - a.position.r).normalized().dot(a.up_e) < std::sin(*m.antenna)) return false;
        }
        return true;
    }

    [[nodiscard]] bool silent(const Source& source, double t) const {
        for (const Blocking& b : r_.blocked) {
            if (t < b.start || t >= b.start + b.duration) continue;
            if (b.sources.empty() && source.satellite) return true;
            for (const std::string& name : b.sources)
                if (name == source.name || (name == "stations" && !source.satellite)) return true;
        }
        if (!source.satellite) return false;
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
        return std::ranges::find(kept, *source.satellite) == kept.end();
    }

    void measure(Source& source, double t, double bias, double drift, double network, RangingLog& log) {
        // every stream advances whatever is in view, so that hiding one satellite leaves the others' numbers as they were
        const double white = source.white.normal(), rate_noise = source.rate.normal();
        if (source.satellite && !allowed_.empty() && std::ranges::find(allowed_, *source.satellite) == allowed_.end()) return;
        const double instant = t - bias / c;   // true time when the receiver's clock shows t
        const auto p = path_to(source, instant);
        if (!p || (source.satellite && !above_masks(*p, instant)) || silent(source, t)) return;
        constexpr double h = 0.05;
        const auto before = path_to(source, instant - h), after = path_to(source, instant + h);
        if (!before || !after) return;

        RangeSample m;
        m.source = log.source(source.name, !source.satellite);
        double fault = 0.0, fault_rate = 0.0;
        for (const RangeFault& f : r_.faults) {
            if (f.source != source.name || t < f.start || t >= f.start + f.duration) continue;
            fault += f.offset + f.ramp * (t - f.start);
            fault_rate += f.ramp + f.rate;
        }
        const double reflected = r_.multipath.amplitude * std::cos(p->direction.elevation) *
                                 std::sin(2.0 * std::numbers::pi * t / r_.multipath.period + source.phase);
        m.pseudorange = p->range + bias - c * p->transmitter.clock + source.errors.white * white + source.correlated + fault + reflected;
        m.range_rate = (after->range - before->range) / (2.0 * h) + drift - c * p->transmitter.clock_rate +
                       source.errors.rate * rate_noise + fault_rate;
        if (!source.satellite) {
            m.pseudorange += network;
            m.range_rate = RangeSample::none;   // extended squitter carries none
        } else {
            m.frequency = gnss::frequency_of(source.satellite->system, '1');
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

    void choose_throughout() {
        if (!r_.masks.throughout || r_.navigation.size() == 0) return;
        for (const Source& source : sources_) {
            if (!source.satellite) continue;
            bool always = true;
            for (double t = 0.0; always && t <= s_.duration; t += 10.0) {
                const auto p = path_to(source, t);
                always = p && p->direction.elevation > r_.masks.elevation;
            }
            if (always) allowed_.push_back(*source.satellite);
        }
    }

    void choose_four() {
        if (r_.limits.empty() || r_.navigation.size() == 0) return;
        const double t = 0.5 * s_.duration;
        const auto all = allowed_.empty() ? gnss::satellites_of(r_.navigation) : allowed_;
        const auto seen = gnss::satellites_in_view(orbits_, all, gps(t), receiver_.at(t).position, r_.masks.elevation);
        for (const gnss::Sighting& s : seen) by_height_.push_back(s.satellite);
        for (const std::size_t i : gnss::best_four(seen)) four_.push_back(seen[i].satellite);
    }

    const RangingScenario& s_;
    const RangingSettings& r_;
    Receiver receiver_;
    gnss::BroadcastSource orbits_;
    std::optional<gnss::KlobucharCoefficients> klobuchar_;
    std::vector<Source> sources_;
    std::vector<gnss::SatelliteId> allowed_, by_height_, four_;
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
