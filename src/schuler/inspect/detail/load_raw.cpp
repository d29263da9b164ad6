// Raw satellite measurements, ephemerides and precise orbits: description of their content.
#include "schuler/core/log.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/single_point.h"
#include "schuler/inspect/detail/recognise.h"
#include "schuler/io/receiver/adsb.h"
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/rinex/antex.h"
#include "schuler/io/rinex/sp3.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace schuler::inspect::detail {
namespace {

using gnss::System;

std::string name_of(System system) {
    static constexpr std::array<const char*, gnss::system_count> names = {"GPS",  "GLONASS", "Galileo", "BeiDou",
                                                                          "QZSS", "SBAS",    "NavIC"};
    return names[static_cast<std::size_t>(system)];
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
}
std::string satellites(std::size_t count) { return counted(count, "satellite", "satellites"); }

std::string stamp(Time t) {
    const Calendar c = utc_from_gps(t + Duration{500'000'000});  // the nearest second: receivers' clocks are early or late
    return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}", c.year, c.month, c.day, c.hour, c.minute,
                       static_cast<int>(c.second));
}
std::string span(Time first, Time last) { return fmt::format("{} to {} UTC", stamp(first), stamp(last)); }

/// One line per system: satellites, signals with their measurements, and the number of satellites per epoch.
void describe_systems(const gnss::ObservationLog& log, std::vector<std::string>& out) {
    struct Seen {
        std::set<std::uint8_t> numbers;
        std::map<std::string, std::string> kinds;  ///< by signal: letters of C, L, D, S
        std::size_t satellite_epochs = 0;
    };
    std::array<Seen, gnss::system_count> seen;
    for (const gnss::ObservationEpoch& epoch : log.epochs) {
        gnss::SatelliteId before;
        for (const gnss::SignalObservation& o : log.of(epoch)) {
            Seen& s = seen[static_cast<std::size_t>(o.satellite.system)];
            s.numbers.insert(o.satellite.number);
            std::string& kinds = s.kinds[{o.signal.band, o.signal.attribute}];
            for (const auto& [letter, value] :
                 {std::pair('C', o.pseudorange), std::pair('L', o.phase), std::pair('D', o.doppler), std::pair('S', o.cn0)}) {
                if (std::isfinite(value) && kinds.find(letter) == std::string::npos) kinds += letter;
            }
            if (o.satellite != before) ++s.satellite_epochs;
            before = o.satellite;
        }
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
        if (seen[i].numbers.empty()) continue;
        for (auto& [signal, kinds] : seen[i].kinds)
            std::ranges::sort(kinds, {}, [](char letter) { return std::string_view("CLDS").find(letter); });
        std::string line = fmt::format("{}: {}, on average {:.1f} an epoch; signals", name_of(static_cast<System>(i)),
                                       satellites(seen[i].numbers.size()),
                                       static_cast<double>(seen[i].satellite_epochs) / static_cast<double>(log.epochs.size()));
        for (const auto& [signal, kinds] : seen[i].kinds) line += fmt::format(" {} ({})", signal, kinds);
        out.push_back(line);
    }
}

/// Ephemerides of one system; times are reference times.
struct Ephemerides {
    std::set<std::uint8_t> numbers;
    std::size_t count = 0;
    Time first, last;
    void add(gnss::SatelliteId s, Time toe) {
        numbers.insert(s.number);
        first = count == 0 ? toe : std::min(first, toe);
        last = count == 0 ? toe : std::max(last, toe);
        ++count;
    }
};

void describe_navigation(const gnss::Navigation& n, std::vector<std::string>& out) {
    std::array<Ephemerides, gnss::system_count> systems;
    const auto take = [&](const auto& all) {
        for (const auto& e : all) systems[static_cast<std::size_t>(e.satellite.system)].add(e.satellite, e.toe);
    };
    take(n.kepler);
    take(n.glonass);
    take(n.sbas);
    for (std::size_t i = 0; i < systems.size(); ++i) {
        const Ephemerides& e = systems[i];
        if (e.count == 0) continue;
        out.push_back(fmt::format("{} of {}: {}, {}", counted(e.count, "ephemeris", "ephemerides"),
                                  name_of(static_cast<System>(i)), satellites(e.numbers.size()), span(e.first, e.last)));
    }
    std::string ionosphere;
    for (std::size_t i = 0; i < n.klobuchar.size(); ++i) {
        if (n.klobuchar[i]) ionosphere += (ionosphere.empty() ? "" : ", ") + name_of(static_cast<System>(i));
    }
    if (n.galileo_ionosphere) ionosphere += ionosphere.empty() ? "Galileo" : ", Galileo";
    if (!ionosphere.empty()) out.push_back("ionosphere coefficients of " + ionosphere);
    if (n.leap_seconds) out.push_back(fmt::format("leap seconds: {}", *n.leap_seconds));
}

/// As in `process`: contradictory ephemerides are not used there.
void tell_contradictions(const gnss::Navigation& n, LoadedFile& file) {
    const gnss::BroadcastSource used(n);
    std::string names;
    for (const gnss::SatelliteId satellite : used.contradicting()) names += (names.empty() ? "" : " ") + gnss::name_of(satellite);
    if (!names.empty()) file.problem(Level::Warning, "ephemerides that contradict each other are not used: " + names, "");
}

std::string described(const Ecef& place) {
    const Geodetic g = earth::geodetic_from_ecef(earth::wgs84, place);
    return fmt::format("{:.6f} deg latitude, {:.6f} deg longitude, {:.1f} m above the ellipsoid", g.lat / units::deg,
                       g.lon / units::deg, g.h);
}

/// Position of the receiver: from the header, or from ranges of the first epoch that can be solved.
void describe_place(const io::RawInput& raw, std::vector<std::string>& out) {
    const gnss::ObservationLog& log = raw.observations;
    if (log.approximate.r.allFinite() && log.approximate.r.norm() > 1e6) {
        out.push_back("approximate position stated in it: " + described(log.approximate));
        return;
    }
    if (raw.navigation.size() == 0) return;
    const gnss::BroadcastSource source(raw.navigation);
    gnss::SinglePoint solver(source, gnss::broadcast_ionosphere(raw.navigation), {});
    // ephemerides take half a minute to be received
    constexpr std::size_t tries = 60;
    const std::size_t step = std::max<std::size_t>(1, log.epochs.size() / tries);
    for (std::size_t i = 0; i < log.epochs.size(); i += step) {
        const gnss::SinglePointSolution s = solver.solve(log.of(log.epochs[i]), log.epochs[i].time, log.channels);
        if (s.status != gnss::SinglePointStatus::Solved) continue;
        out.push_back(fmt::format("position by the ranges of {} UTC: {}", stamp(s.time), described(s.position)));
        return;
    }
}

void describe_observations(const io::RawInput& raw, LoadedFile& file) {
    const gnss::ObservationLog& log = raw.observations;
    std::vector<std::string>& out = file.report.contents;
    std::vector<double> times;
    for (const gnss::ObservationEpoch& epoch : log.epochs) {
        file.time_ns.push_back(epoch.time.ns);
        times.push_back((epoch.time - log.epochs.front().time).seconds());
    }
    const Cadence cadence = cadence_of(times);
    std::string interval = times.size() > 1 ? fmt::format(", every {:.4g} s", cadence.step) : "";
    if (cadence.missing > 0) interval += fmt::format(", {} missing", cadence.missing);
    out.push_back(fmt::format("{} of raw measurements, {}{}", counted(times.size(), "epoch", "epochs"),
                              span(log.epochs.front().time, log.epochs.back().time), interval));
    if (!log.marker.empty()) out.push_back("marker " + log.marker);
    describe_systems(log, out);
    describe_place(raw, out);
}

}  // namespace

bool read_raw(LoadedFile& file, io::RawFormat format) {
    static constexpr std::array<const char*, 6> kinds = {"unknown", "rinex_obs", "rinex_nav", "ubx", "rtcm3", "novatel"};
    WarningLog log;
    io::RawInput raw;
    try {
        raw = io::read_raw_input(file.path, {}, log);
    } catch (const Error&) {
        // logs of sentences with a few binary messages in between
        if (format == io::RawFormat::Ubx && io::is_nmea(io::TextInput(file.path))) return false;
        file.report.kind = kinds[static_cast<std::size_t>(format)];
        throw;
    }
    file.report.kind = kinds[static_cast<std::size_t>(format)];
    file.gps_time = true;
    std::vector<std::string>& provides = file.report.provides;
    if (!raw.observations.epochs.empty()) {
        describe_observations(raw, file);
        provides.emplace_back("ranges");
    }
    if (raw.navigation.size() > 0) provides.emplace_back("ephemerides");
    if (!raw.fixes.empty()) provides.emplace_back("fixes");
    describe_navigation(raw.navigation, file.report.contents);
    tell_contradictions(raw.navigation, file);
    if (!raw.fixes.empty())
        file.report.contents.push_back(fmt::format("{} of the receiver itself, {}", counted(raw.fixes.size(), "fix", "fixes"),
                                                   span(raw.fixes.front().time, raw.fixes.back().time)));
    for (const std::string& warning : log.summary()) file.problem(Level::Warning, warning, "");
    return true;
}

void read_squitters(LoadedFile& file) {
    WarningLog log;
    file.report.kind = "adsb";
    const io::AdsbLog squitters = io::read_adsb(io::TextInput(file.path), {}, log);
    std::set<std::uint32_t> addresses;
    for (const io::SquitterPosition& p : squitters.positions) addresses.insert(p.address);
    file.report.contents.push_back(fmt::format("{} of 1090 MHz, {}",
                                               counted(squitters.messages.read, "extended squitter", "extended squitters"),
                                               counted(squitters.positions.size(), "position", "positions")));
    file.report.contents.push_back(counted(addresses.size(), "address", "addresses") + " with a position");
    const std::vector<io::StationRow> stations = io::stations_of(squitters);
    for (const io::StationRow& s : stations)
        file.report.contents.push_back(
            fmt::format("{} stays at {}", s.id, described(earth::ecef_from_geodetic(earth::wgs84, s.position))));
    if (stations.empty())
        file.problem(Level::Info, "no address stays where it is over five reports: these are aircraft, not stations", "");
    for (const std::string& warning : log.summary()) file.problem(Level::Warning, warning, "");
}

void read_antennas(LoadedFile& file) {
    WarningLog log;
    file.report.kind = "antex";
    const gnss::Antennas antennas = io::read_antex(io::TextInput(file.path), log).antennas;
    file.report.contents.push_back(fmt::format("calibrations of {} and of {}",
                                               counted(antennas.receivers.size(), "receiver antenna", "receiver antennas"),
                                               counted(antennas.satellites.size(), "satellite antenna", "satellite antennas")));
    for (const std::string& warning : log.summary()) file.problem(Level::Warning, warning, "");
}

void read_precise_orbits(LoadedFile& file) {
    WarningLog log;
    file.report.kind = "sp3";
    file.report.provides.emplace_back("orbits");
    const io::Sp3File sp3 = io::read_sp3(io::TextInput(file.path), log);
    std::array<Ephemerides, gnss::system_count> systems;
    for (std::size_t i = 0; i < sp3.nodes.size(); ++i) {
        const gnss::SatelliteId satellite{static_cast<System>(i / gnss::numbers_per_system),
                                          static_cast<std::uint8_t>(i % gnss::numbers_per_system)};
        for (const auto& node : sp3.nodes[i]) systems[i / gnss::numbers_per_system].add(satellite, node.time);
    }
    file.report.contents.push_back(fmt::format("precise orbits and clocks, {}", counted(sp3.epochs, "epoch", "epochs")));
    for (std::size_t i = 0; i < systems.size(); ++i) {
        if (systems[i].count > 0)
            file.report.contents.push_back(fmt::format("{}: {}, {}", name_of(static_cast<System>(i)),
                                                       satellites(systems[i].numbers.size()),
                                                       span(systems[i].first, systems[i].last)));
    }
    for (const std::string& warning : log.summary()) file.problem(Level::Warning, warning, "");
}

}  // namespace schuler::inspect::detail
