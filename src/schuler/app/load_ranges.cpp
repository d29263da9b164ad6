#include "schuler/app/load_ranges.h"

#include "schuler/app/raw_gnss.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/sampled_ranges.h"
#include "schuler/io/adsb.h"
#include "schuler/io/csv_ranges.h"
#include "schuler/io/raw_input.h"

#include <algorithm>
#include <cmath>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

/// Fills in where the transmitters were, from a list of stations and from ephemerides.
void place_transmitters(RangingLog& log, const std::vector<io::StationRow>& stations, const gnss::SatelliteSource* orbits,
                        Duration to_gps, WarningLog& warnings) {
    std::size_t lost = 0;
    RangingLog out;
    out.sources = log.sources;
    for (const RangeEpoch& e : log.epochs) {
        RangeEpoch kept{e.time, out.samples.size(), 0};
        for (RangeSample m : log.of(e)) {
            const RangeSource& source = log.sources[m.source];
            if (source.station) {
                const auto row = std::ranges::find_if(stations, [&](const io::StationRow& s) {
                    return s.id == source.name || "ADSB-" + s.id == source.name;
                });
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
        warnings.add("stations.unknown", "ranges to sources whose place is not known (no tx columns, coordinates or navigation file): left out", lost);
    log = std::move(out);
}

/// From a list, or from what the stations say of themselves in a receiver's log.
std::vector<io::StationRow> stations_from(const fs::path& folder, const Config& c, WarningLog& warnings) {
    if (c.station_coordinates.empty()) return {};
    const io::TextInput input(resolved(folder, c.station_coordinates, "stations.coordinates"));
    if (!io::is_adsb(input)) return io::read_stations_csv(input, {}, warnings);
    std::vector<io::StationRow> stations = io::stations_of(io::read_adsb(input, {}, warnings));
    const std::size_t all = stations.size();
    std::erase_if(stations, [](const io::StationRow& s) { return !std::isfinite(s.position.h); });
    if (stations.size() < all)
        warnings.add("stations.height", "stations that report no height: left out", all - stations.size());
    if (stations.empty())
        throw input_error("no station reports its place in this log of extended squitters",
                          {.file = c.station_coordinates, .line = 0, .column = 0, .key = {}},
                          "a station stays where it is over five reports or more; otherwise give stations.csv");
    return stations;
}

gnss::Navigation read_navigation(const fs::path& folder, const Config& c, WarningLog& warnings) {
    gnss::Navigation navigation;
    for (const std::string& file : c.raw.navigation)
        navigation.add(io::read_raw_input(resolved(folder, file, "gnss.navigation"), {}, warnings).navigation);
    return navigation;
}

}  // namespace

RangingLog ranges_from_csv(const fs::path& folder, const Config& c, WarningLog& warnings) {
    io::CsvOptions options;
    options.columns = c.ranges.columns;
    options.scale = c.ranges.scale;
    options.time_offset = Duration::from_seconds(c.ranges.time_offset);
    RangingLog log = io::read_ranges_csv(resolved(folder, c.ranges.file, "stations.file"), options, warnings).log;
    const std::vector<io::StationRow> stations = stations_from(folder, c, warnings);
    const gnss::Navigation navigation = read_navigation(folder, c, warnings);
    const gnss::BroadcastSource orbits(navigation);
    const Duration to_gps = c.time.week ? Time::from_gps(*c.time.week, 0.0) - Time{} : Duration{};
    place_transmitters(log, stations, navigation.size() > 0 ? &orbits : nullptr, to_gps, warnings);
    if (log.empty())
        throw input_error("has no range to a source whose place is known", {c.ranges.file, 0, 0, {}},
                          "give tx_x_m, tx_y_m, tx_z_m, or [stations] coordinates and [gnss] navigation");
    return log;
}

RangingLog ranges_from_raw(const fs::path& folder, Config& c, WarningLog& warnings) {
    gnss::Navigation navigation = read_navigation(folder, c, warnings);
    RangingLog log;
    std::vector<gnss::Range> ranges;
    std::vector<gnss::ObservationLog> logs;
    for (const std::string& file : c.raw.observations) {
        io::RawInput input = io::read_raw_input(resolved(folder, file, "gnss.observations"), {}, warnings);
        navigation.add(input.navigation);
        logs.push_back(std::move(input.observations));
    }
    const gnss::BroadcastSource orbits(navigation);
    for (const gnss::ObservationLog& raw : logs) {
        for (const gnss::ObservationEpoch& e : raw.epochs) {
            gnss::prepare_ranges(raw.of(e), e.time, orbits, raw.channels, c.raw.solver.ranges, ranges);
            if (ranges.empty() || (!log.epochs.empty() && e.time <= log.epochs.back().time)) continue;
            log.epochs.push_back({e.time, log.samples.size(), ranges.size()});
            for (const gnss::Range& r : ranges) {
                RangeSample m;
                m.source = log.source(gnss::name_of(r.satellite), false);
                m.pseudorange = r.pseudorange;
                m.range_rate = r.range_rate;
                m.cn0 = r.cn0;
                m.tx = r.position;
                m.tx_velocity = r.velocity;
                m.frequency = r.frequency;
                log.samples.push_back(m);
            }
        }
    }
    fusion::RangingFilterSettings& f = c.filter.ranging;
    f.klobuchar = gnss::klobuchar_of(navigation);
    f.sigma_by_elevation = true;
    return log;
}

std::vector<GnssFix> fixes_from_ranges(const RangingLog& log, const Config& c) {
    const gnss::BroadcastSource nobody{gnss::Navigation{}};
    gnss::SinglePoint solver(nobody, c.filter.ranging.klobuchar, c.raw.solver);
    std::vector<GnssFix> out;
    for (const RangeEpoch& e : log.epochs) {
        const gnss::SinglePointSolution s = solver.solve(gnss::satellite_ranges(log, e), e.time);
        if (s.status == gnss::SinglePointStatus::Solved) out.push_back(fix_from(s));
    }
    return out;
}

}  // namespace schuler::app
