// [ranges] of scenario files: satellites and stations, masks, and range errors.
#include "schuler/core/units.h"
#include "schuler/gnss/constellation.h"
#include "schuler/io/raw_input.h"
#include "schuler/settings/list_options.h"
#include "schuler/settings/range_error_options.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/scenario/sections.h"

#include <algorithm>
#include <cmath>

namespace schuler::settings {
namespace {

using S = ScenarioConfig;
using units::deg;

using R = sim::RangingSettings;
using Entries = std::vector<Entry>;

void add_sources(OptionTable<S>& table) {
    using sim::Blocking, sim::GroundStation, sim::RangeFault, sim::SatelliteLimit;
    const auto list = [](auto field) { return [=](S& s) -> auto& { return s.ranging.settings.*field; }; };
    table
        .add(list_of<S, GroundStation>(
            "ranges.stations", "[ { id, lat_deg, lon_deg, height_m }, ... ]", "ground stations that send ranges",
            list(&R::stations),
            [](GroundStation& g) {
                return Entries{{.name = "id", .text = &g.name},
                               {.name = "lat_deg", .number = &g.position.lat, .factor = deg},
                               {.name = "lon_deg", .number = &g.position.lon, .factor = deg},
                               {.name = "height_m", .number = &g.position.h}};
            },
            [](std::vector<GroundStation>& stations, const GroundStation& g) {
                if (g.name.empty()) throw input_error("a station has no id", {}, "give each one");
                stations.push_back(g);
            }))
        .add(list_of<S, Blocking>(
            "ranges.block", "[ { sources, start_s, duration_s }, ... ]",
            "sources that send nothing for a time; without names all satellites, \"stations\" for all stations",
            list(&R::blocked),
            [](Blocking& b) {
                return Entries{{.name = "sources", .texts = &b.sources},
                               {.name = "start_s", .number = &b.start},
                               {.name = "duration_s", .number = &b.duration}};
            }))
        .add(list_of<S, SatelliteLimit>(
            "ranges.limit", "[ { start_s, keep, variant }, ... ]",
            "limits the number of satellites from start_s on: up to four those with the best geometry, more the highest ones",
            list(&R::limits),
            [](SatelliteLimit& l) {
                return Entries{{.name = "start_s", .number = &l.start},
                               {.name = "keep", .count = &l.keep},
                               {.name = "variant", .count = &l.variant}};
            }))
        .add(list_of<S, RangeFault>(
            "ranges.fault", "[ { source, start_s, duration_s, offset_m, ramp_m_s, rate_m_s }, ... ]", "faults of ranges",
            list(&R::faults), [](RangeFault& f) {
                return Entries{{.name = "source", .text = &f.source},         {.name = "start_s", .number = &f.start},
                               {.name = "duration_s", .number = &f.duration}, {.name = "offset_m", .number = &f.offset},
                               {.name = "ramp_m_s", .number = &f.ramp},       {.name = "rate_m_s", .number = &f.rate}};
            }));
}

}  // namespace

void add_ranging_scenario_options(OptionTable<S>& table) {
    const auto settings = [](auto field) { return [=](auto& s) -> auto& { return s.ranging.settings.*field; }; };
    table
        .add(number<S>("ranges.rate_hz", 1.0, 0, 1000, "rate of raw ranges (ranges.csv); 0 = none",
                       [](auto& s) -> auto& { return s.ranging.rate; }))
        .add(text<S>("ranges.systems", "nominal constellations: G = GPS, R = GLONASS, 24 satellites each; \"-\" = none",
                     [](auto& s) -> auto& { return s.ranging.systems; }))
        .add(text<S>("ranges.navigation", "a RINEX navigation file instead of nominal constellations",
                     [](auto& s) -> auto& { return s.ranging.navigation; }))
        .add(integer<S>("ranges.gps_week", 0, 20000, "GPS week of the start", [](auto& s) -> auto& { return s.ranging.week; }))
        .add(number<S>("ranges.gps_second", 1.0, 0, 604800, "second of that week at the start",
                       [](auto& s) -> auto& { return s.ranging.second; }))
        .add(flag<S>("ranges.rinex", "write RINEX observations and navigation files too",
                     [](auto& s) -> auto& { return s.ranging.rinex; }))
        .add(number<S>("ranges.elevation_mask_deg", deg, -10, 90, "satellites below this elevation are not tracked",
                       [](auto& s) -> auto& { return s.ranging.settings.masks.elevation; }))
        .add(flag<S>("ranges.throughout", "use only satellites that stay above the mask during the whole scenario",
                     [](auto& s) -> auto& { return s.ranging.settings.masks.throughout; }))
        .add(number<S>("ranges.antenna_mask_deg", deg, -90, 90, "mask angle above the antenna's plane, which banks with the body",
                       [](auto& s) -> auto& { return s.ranging.settings.masks.antenna; }))
        .add(list_of<S, sim::Masks::Sector>(
            "ranges.terrain", "[ { azimuth_deg, elevation_deg }, ... ]",
            "terrain: mask elevation from an azimuth to the next one",
            [](S& s) -> auto& { return s.ranging.settings.masks.terrain; },
            [](sim::Masks::Sector& sector) {
                return Entries{{.name = "azimuth_deg", .number = &sector.azimuth, .factor = deg},
                               {.name = "elevation_deg", .number = &sector.elevation, .factor = deg}};
            },
            [](std::vector<sim::Masks::Sector>& terrain, const sim::Masks::Sector& sector) {
                terrain.insert(std::ranges::upper_bound(terrain, sector.azimuth, {}, &sim::Masks::Sector::azimuth), sector);
            }))
        .add(number<S>("ranges.multipath_m", 1.0, 0, 1e3, "amplitude of reflections at the horizon",
                       [](auto& s) -> auto& { return s.ranging.settings.multipath.amplitude; }))
        .add(number<S>("ranges.multipath_period_s", 1.0, 0.01, 1e5, "period of the reflections",
                       [](auto& s) -> auto& { return s.ranging.settings.multipath.period; }))
        .add(number<S>("ranges.receiver_acceleration_m_s_sqrt_s", 1.0, 1e-4, 1e3,
                       "intermediate: white acceleration assumed by the receiver-only filter",
                       [](auto& s) -> auto& { return s.processing.filter.ranging.receiver_acceleration; }))
        .add(flag<S>("ranges.atmosphere", "ranges are delayed by troposphere and ionosphere", settings(&R::atmosphere)));
    add_sources(table);
    add_range_error_options(table, [](auto& s) -> auto& { return s.ranging.settings.errors; });
    table.add(number<S>("baro.bias_time_s", 1.0, 0, 1e7,
                        "correlation time of the barometer's bias; 0 = constant with a random walk",
                        [](auto& s) -> auto& { return s.sim.baro.bias_time; }));
}

sim::RangingScenario ranging_frame(const ScenarioConfig& s) {
    return {s.sim.seed, s.sim.duration, s.sim.origin, Time::from_gps(s.ranging.week, s.ranging.second), s.sim.earth};
}

sim::RangingSettings ranging_settings(const ScenarioConfig& s) {
    sim::RangingSettings r = s.ranging.settings;
    const Time begin = ranging_frame(s).gps, end = begin + Duration::from_seconds(s.sim.duration);
    if (s.ranging.rate > 0.0) r.rate = s.ranging.rate;
    r.lever_arm_b = s.sim.gnss.lever_arm_b;
    if (!s.ranging.navigation.empty()) {
        WarningLog unheard;
        const std::filesystem::path file(s.ranging.navigation);
        r.navigation = io::read_raw_input(file.is_absolute() ? file : s.folder / file, {}, unheard).navigation;
    } else {
        if (s.ranging.systems.find('G') != std::string::npos) r.navigation.add(gnss::nominal_gps(begin, end));
        if (s.ranging.systems.find('R') != std::string::npos) r.navigation.add(gnss::nominal_glonass(begin, end));
    }
    return r;
}

}  // namespace schuler::settings
