#include "schuler/dataset/ranges.h"

#include "schuler/core/error.h"
#include "schuler/dataset/paths.h"
#include "schuler/dataset/raw_gnss.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/phase_noise.h"
#include "schuler/gnss/sampled_ranges.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/receiver/adsb.h"
#include "schuler/io/text/csv/csv_ranges.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

/// Fills in the positions of the transmitters, from a list of stations and from ephemerides.
void place_transmitters(RangingLog& log, const std::vector<io::StationRow>& stations, const gnss::SatelliteSource* orbits,
                        Duration to_gps, WarningLog& warnings) {
    std::size_t lost = 0;
    RangingLog out;
    out.sources = log.sources;
    out.to_gps = log.to_gps;
    for (const RangeEpoch& e : log.epochs) {
        RangeEpoch kept{e.time, out.samples.size(), 0};
        for (RangeSample m : log.of(e)) {
            const RangeSource& source = log.sources[m.source];
            if (source.station) {
                const auto row = std::ranges::find_if(
                    stations, [&](const io::StationRow& s) { return s.id == source.name || "ADSB-" + s.id == source.name; });
                if (row != stations.end()) m.tx = earth::ecef_from_geodetic(earth::wgs84, row->position);
                if (row != stations.end()) m.tx_velocity.setZero();
            } else if (!m.tx.r.allFinite() && orbits != nullptr) {
                const auto id = gnss::satellite_from(source.name);
                const Time sent = e.time + to_gps - Duration::from_seconds(m.pseudorange / gnss::speed_of_light);
                const auto first = id ? orbits->at(*id, {}, sent) : std::nullopt;
                const auto found = first ? orbits->at(*id, {}, sent - Duration::from_seconds(first->state.clock)) : std::nullopt;
                if (found) {
                    m.tx = found->state.position;
                    m.tx_velocity = found->state.velocity;
                    m.tx_clock = found->state.clock - found->group_delay;
                    m.tx_clock_rate = found->state.clock_rate;
                }
            }
            if (!m.tx.r.allFinite()) {
                ++lost;
                continue;
            }
            out.samples.push_back(m);
            ++kept.count;
        }
        if (kept.count > 0) out.epochs.push_back(kept);
    }
    if (lost > 0)
        warnings.add("stations.unknown",
                     "ranges to sources whose place is not known (no tx columns, coordinates or navigation file): left out",
                     lost);
    log = std::move(out);
}

/// From a list, or from the positions reported by the stations in a receiver's log.
std::vector<io::StationRow> stations_from(const fs::path& folder, const Description& d, WarningLog& warnings) {
    if (d.station_coordinates.empty()) return {};
    const io::TextInput input(resolved(folder, d.station_coordinates, "stations.coordinates"));
    if (!io::is_adsb(input)) return io::read_stations_csv(input, {}, warnings);
    std::vector<io::StationRow> stations = io::stations_of(io::read_adsb(input, {}, warnings));
    const std::size_t all = stations.size();
    std::erase_if(stations, [](const io::StationRow& s) { return !std::isfinite(s.position.h); });
    if (stations.size() < all) warnings.add("stations.height", "stations that report no height: left out", all - stations.size());
    if (stations.empty())
        throw input_error("no station reports its place in this log of extended squitters",
                          {.file = d.station_coordinates, .line = 0, .column = 0, .key = {}},
                          "a station stays where it is over five reports or more; otherwise give stations.csv");
    return stations;
}

gnss::Navigation read_navigation(const fs::path& folder, const Description& d, WarningLog& warnings) {
    gnss::Navigation navigation;
    for (const std::string& file : d.raw.navigation)
        navigation.add(io::read_raw_input(resolved(folder, file, "gnss.navigation"), {}, warnings).navigation);
    return navigation;
}

}  // namespace

RangingLog ranges_from_csv(const fs::path& folder, const Description& d, WarningLog& warnings) {
    io::CsvOptions options;
    options.columns = d.ranges.columns;
    options.scale = d.ranges.scale;
    options.time_offset = Duration::from_seconds(d.ranges.time_offset);
    RangingLog log = io::read_ranges_csv(resolved(folder, d.ranges.file, "stations.file"), options, warnings).log;
    const std::vector<io::StationRow> stations = stations_from(folder, d, warnings);
    const gnss::Navigation navigation = read_navigation(folder, d, warnings);
    const gnss::BroadcastSource orbits(navigation);
    const Duration to_gps = d.time.week ? Time::from_gps(*d.time.week, 0.0) - Time{} : Duration{};
    log.to_gps = to_gps;
    place_transmitters(log, stations, navigation.size() > 0 ? &orbits : nullptr, to_gps, warnings);
    if (log.empty())
        throw input_error("has no range to a source whose place is known", {d.ranges.file, 0, 0, {}},
                          "give tx_x_m, tx_y_m, tx_z_m, or [stations] coordinates and [gnss] navigation");
    return log;
}

namespace {

/// Range rates from the phases of two epochs.
class PhaseRates {
public:
    /// The rate of a satellite at an epoch, over its interval from the epoch before; empty where it cannot be had.
    struct Rate {
        double rate = 0.0, span = 0.0;  ///< m/s, s
    };
    void begin(Time tag) {
        before_ = std::exchange(now_, {});
        before_tag_ = std::exchange(tag_, tag);
    }
    [[nodiscard]] std::optional<Rate> next(const gnss::Range& r) {
        now_[r.satellite] = r;
        const auto old = before_.find(r.satellite);
        if (old == before_.end() || old->second.signal != r.signal || r.phase_lost || old->second.half_cycle != r.half_cycle)
            return std::nullopt;
        constexpr double longest = 1.05, apart = 2.0;  // s; m/s: a slip of many cycles, a step of the clock
        const double span = (tag_ - before_tag_).seconds(), rate = (r.phase - old->second.phase) / span,
                     doppler = 0.5 * (r.range_rate + old->second.range_rate);
        if (!(span > 0.0) || span > longest || !std::isfinite(rate) || std::abs(rate - doppler) > apart) return std::nullopt;
        return Rate{rate, span};
    }

private:
    std::map<gnss::SatelliteId, gnss::Range> before_, now_;
    Time before_tag_{}, tag_{};
};

}  // namespace

RawRanges ranges_from_raw(const fs::path& folder, const Description& d, bool phase_rates, WarningLog& warnings) {
    gnss::Navigation navigation = read_navigation(folder, d, warnings);
    RawRanges out;
    RangingLog& log = out.log;
    std::vector<gnss::Range> ranges;
    std::vector<gnss::ObservationLog> logs;
    for (const std::string& file : d.raw.observations) {
        io::RawInput input = io::read_raw_input(resolved(folder, file, "gnss.observations"), {}, warnings);
        navigation.add(input.navigation);
        logs.push_back(std::move(input.observations));
    }
    const auto orbits = satellites(folder, d.raw, navigation, warnings);
    warn_of_group_delays(d.raw, warnings);
    PhaseRates phases;
    std::vector<double> spans;
    for (const gnss::ObservationLog& raw : logs) {
        for (const gnss::ObservationEpoch& e : raw.epochs) {
            gnss::prepare_ranges(raw.of(e), e.time, *orbits, raw.channels, d.raw.solver.ranges, ranges);
            if (ranges.empty() || (!log.epochs.empty() && e.time <= log.epochs.back().time)) continue;
            log.epochs.push_back({e.time, log.samples.size(), ranges.size()});
            phases.begin(e.time);
            for (const gnss::Range& r : ranges) {
                RangeSample m;
                m.source = log.source(gnss::name_of(r.satellite), false);
                m.pseudorange = r.pseudorange;
                m.range_rate = r.range_rate;
                m.cn0 = r.cn0;
                m.tx = r.position;
                m.tx_velocity = r.velocity;
                m.frequency = r.frequency;
                m.variance = r.variance;
                m.noise = r.noise;
                if (const auto phase = phase_rates ? phases.next(r) : std::nullopt) {
                    m.doppler_rate = std::exchange(m.range_rate, phase->rate);
                    m.phase_span = phase->span;
                    spans.push_back(phase->span);
                }
                log.samples.push_back(m);
            }
        }
    }
    if (!spans.empty()) {
        out.phase_span = math::median(std::move(spans));
        out.phase_change = gnss::phase_change_sigma(log, d.raw.solver);
    }
    out.ionosphere = gnss::broadcast_ionosphere(navigation);
    warn_of_missing_ionosphere(out.ionosphere, d.raw, warnings);
    return out;
}

RangingLog with_own(RangingLog relative, const RangingLog& own) {
    RangingLog out;
    out.sources = std::move(relative.sources);
    out.carriers = std::move(relative.carriers);
    const auto take = [&out](const RangingLog& from, const RangeEpoch& e, bool rename) {
        RangeEpoch& added = out.epochs.emplace_back(e);
        added.first = out.samples.size();
        for (RangeSample m : from.of(e)) {
            if (rename) m.source = out.source(from.sources[m.source].name + " alone", from.sources[m.source].station);
            out.samples.push_back(m);
        }
    };
    auto next = relative.epochs.begin();
    for (const RangeEpoch& e : own.epochs) {
        while (next != relative.epochs.end() && next->time <= e.time) take(relative, *next++, false);
        if (out.epochs.empty() || out.epochs.back().time != e.time) take(own, e, true);
    }
    while (next != relative.epochs.end()) take(relative, *next++, false);
    return out;
}

namespace {

/// One sigma of the position's jump between two solutions, Earth-fixed covariance, m^2: the slow error of every range is
/// unchanged, but its contribution to the position changes.
Eigen::Matrix3d jump_between(const gnss::SinglePointSolution& before, const gnss::SinglePointSolution& after) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    const auto in = [](const gnss::SinglePointSolution& s, gnss::SatelliteId id) {
        const auto it = std::ranges::find(s.satellites, id, &gnss::SatelliteUse::satellite);
        return it == s.satellites.end() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : it->gain;
    };
    const auto add = [&sum](const Eigen::Vector3d& by, double variance) { sum += variance * by * by.transpose(); };
    for (const gnss::SatelliteUse& u : after.satellites) add(u.gain - in(before, u.satellite), u.slow_variance);
    for (const gnss::SatelliteUse& u : before.satellites)
        if (std::ranges::find(after.satellites, u.satellite, &gnss::SatelliteUse::satellite) == after.satellites.end())
            add(u.gain, u.slow_variance);
    return sum;
}

/// Sigmas north, east, down of many epochs.
class LevelSigmas {
public:
    void add(const Eigen::Matrix3d& covariance_e, const Geodetic& at) {
        const Eigen::Matrix3d C_ne = earth::C_en(at.lat, at.lon).transpose();
        const Eigen::Vector3d sigma = (C_ne * covariance_e * C_ne.transpose()).diagonal().cwiseSqrt();
        for (std::size_t i = 0; i < 3; ++i) axes_[i].push_back(sigma(static_cast<Eigen::Index>(i)));
    }
    /// Zero if there are none.
    [[nodiscard]] Eigen::Vector3d median() const {
        if (axes_[0].empty()) return Eigen::Vector3d::Zero();
        return {math::median(axes_[0]), math::median(axes_[1]), math::median(axes_[2])};
    }

private:
    std::array<std::vector<double>, 3> axes_;
};

}  // namespace

RangeFixes fixes_from_ranges(const RangingLog& log, const std::optional<gnss::BroadcastIonosphere>& ionosphere,
                             const gnss::SinglePointSettings& settings, double slow, double slow_rate) {
    const gnss::BroadcastSource nobody{gnss::Navigation{}};
    gnss::SinglePoint solver(nobody, ionosphere, settings);
    RangeFixes out;
    LevelSigmas sigmas, jumps, velocities;
    std::optional<gnss::SinglePointSolution> before;
    for (const RangeEpoch& e : log.epochs) {
        std::vector<gnss::Range> ranges = gnss::satellite_ranges(log, e);
        double slow_share = 0.0;  // of the variance of a velocity: the geometry is that of all errors
        for (gnss::Range& r : ranges) {
            r.slow = slow;
            if (!(slow_rate > 0.0 && r.sigma_rate > 0.0)) continue;
            r.sigma_rate = std::hypot(r.sigma_rate, slow_rate);
            slow_share += slow_rate * slow_rate / (r.sigma_rate * r.sigma_rate * static_cast<double>(ranges.size()));
        }
        gnss::SinglePointSolution s = solver.solve(std::move(ranges), e.time);
        if (s.status != gnss::SinglePointStatus::Solved) continue;
        const GnssFix& fix = out.fixes.emplace_back(fix_from(s));
        sigmas.add(s.slow_covariance, fix.position);
        if (s.velocity.allFinite()) velocities.add(slow_share * s.velocity_covariance, fix.position);
        if (before && before->used() != s.used()) jumps.add(jump_between(*before, s), fix.position);
        before = std::move(s);
    }
    out.slow = sigmas.median();
    out.change = jumps.median();
    out.slow_velocity = velocities.median();
    return out;
}

}  // namespace schuler::dataset
