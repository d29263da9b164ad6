#include "schuler/io/rinex/rinex_write.h"

#include "schuler/gnss/system_time.h"
#include "schuler/io/rinex/detail/rinex_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <set>
#include <tuple>
#include <vector>

namespace schuler::io {
namespace {

using gnss::Signal;
using gnss::System;

void line(std::string& out, const std::string& text, std::string_view label) {
    out += fmt::format("{:<60}{:<20}\n", text, label);
}

/// Calendar of a continuous time scale, with the second and the following ticks of 100 ns kept separate.
struct Stamp {
    Calendar day;
    int second;
    int ticks;
};
Stamp stamp_of(Time t) {
    constexpr std::int64_t tick = 100, minute = 60 * detail::ns_per_second, day = 1440 * minute;
    const std::int64_t rounded = (t.ns + tick / 2) / tick * tick, in_day = rounded % day, in_minute = in_day % minute;
    using namespace std::chrono;
    const year_month_day date = sys_days(year{1980} / January / 6) + days(rounded / day);
    const Calendar c{static_cast<int>(date.year()),
                     static_cast<int>(static_cast<unsigned>(date.month())),
                     static_cast<int>(static_cast<unsigned>(date.day())),
                     static_cast<int>(in_day / (60 * minute)),
                     static_cast<int>(in_day % (60 * minute) / minute),
                     0.0};
    return {c, static_cast<int>(in_minute / detail::ns_per_second), static_cast<int>(in_minute % detail::ns_per_second / tick)};
}

using Signals = std::array<std::set<Signal>, gnss::system_count>;

Signals signals_of(const gnss::ObservationLog& log) {
    Signals found;
    for (const gnss::SignalObservation& o : log.observations)
        found[static_cast<std::size_t>(o.satellite.system)].insert(o.signal);
    return found;
}

void observation_header(std::string& out, const gnss::ObservationLog& log, const Signals& signals) {
    line(out, "     3.04           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE");
    line(out, "schuler", "PGM / RUN BY / DATE");
    line(out, log.marker, "MARKER NAME");
    for (const std::string_view label : {"OBSERVER / AGENCY", "REC # / TYPE / VERS"}) line(out, "", label);
    line(out, fmt::format("{:20}{:20.20}", "", log.antenna), "ANT # / TYPE");
    const auto three = [](const Eigen::Vector3d& v) {
        return v.allFinite() ? fmt::format("{:14.4f}{:14.4f}{:14.4f}", v.x(), v.y(), v.z())
                             : fmt::format("{0:14.4f}{0:14.4f}{0:14.4f}", 0.0);
    };
    line(out, three(log.approximate.r), "APPROX POSITION XYZ");
    line(out, three(log.antenna_delta), "ANTENNA: DELTA H/E/N");
    for (std::size_t i = 0; i < signals.size(); ++i) {
        if (signals[i].empty()) continue;
        std::string text = fmt::format("{}  {:3}", gnss::letter_of(static_cast<System>(i)), 4 * signals[i].size());
        std::size_t count = 0;
        for (const Signal s : signals[i]) {
            for (const char kind : {'C', 'L', 'D', 'S'}) {
                constexpr std::size_t on_a_line = 13;
                if (count > 0 && count % on_a_line == 0) {
                    line(out, text, "SYS / # / OBS TYPES");
                    text = "      ";
                }
                text += fmt::format(" {}{}{}", kind, s.band, s.attribute);
                ++count;
            }
        }
        line(out, text, "SYS / # / OBS TYPES");
    }
    if (!log.epochs.empty()) {
        const Stamp t = stamp_of(log.epochs.front().time);
        line(out,
             fmt::format("{:6}{:6}{:6}{:6}{:6}{:5}.{:07}     GPS", t.day.year, t.day.month, t.day.day, t.day.hour, t.day.minute,
                         t.second, t.ticks),
             "TIME OF FIRST OBS");
    }
    std::vector<std::string> slots;
    for (std::size_t slot = 1; slot < log.channels.of_slot.size(); ++slot) {
        if (log.channels.of_slot[slot] != gnss::unknown_channel)
            slots.push_back(fmt::format("R{:02} {:2} ", slot, log.channels.of_slot[slot]));
    }
    for (std::size_t i = 0; i < slots.size(); i += 8) {
        std::string text = i == 0 ? fmt::format("{:3} ", slots.size()) : "    ";
        for (std::size_t k = i; k < std::min(i + 8, slots.size()); ++k) text += slots[k];
        line(out, text, "GLONASS SLOT / FRQ #");
    }
    line(out, "", "END OF HEADER");
}

void field(std::string& out, double value, int loss_of_lock = 0, int strength = 0) {
    if (!std::isfinite(value)) {
        out.append(16, ' ');
        return;
    }
    out += fmt::format("{:14.3f}{}{}", value, loss_of_lock > 0 ? static_cast<char>('0' + loss_of_lock) : ' ',
                       strength > 0 ? static_cast<char>('0' + strength) : ' ');
}

}  // namespace

std::string rinex_observations_text(const gnss::ObservationLog& log) {
    std::string out;
    const Signals signals = signals_of(log);
    observation_header(out, log, signals);
    for (const gnss::ObservationEpoch& epoch : log.epochs) {
        const auto all = log.of(epoch);
        std::string body;
        int satellites = 0;
        for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
            while (last < all.size() && all[last].satellite == all[first].satellite) ++last;
            ++satellites;
            body += gnss::name_of(all[first].satellite);
            for (const Signal s : signals[static_cast<std::size_t>(all[first].satellite.system)]) {
                const auto of_satellite = all.subspan(first, last - first);
                const auto o = std::ranges::find(of_satellite, s, &gnss::SignalObservation::signal);
                const gnss::SignalObservation missing{};
                const gnss::SignalObservation& x = o == of_satellite.end() ? missing : *o;
                field(body, x.pseudorange);
                field(body, x.phase, x.loss_of_lock, x.strength);
                field(body, x.doppler);
                field(body, x.cn0);
            }
            while (body.back() == ' ') body.pop_back();
            body += '\n';
        }
        const Stamp t = stamp_of(epoch.time);
        out += fmt::format("> {:4} {:02} {:02} {:02} {:02} {:2}.{:07}  {}{:3}\n", t.day.year, t.day.month, t.day.day, t.day.hour,
                           t.day.minute, t.second, t.ticks, epoch.power_failure ? 1 : 0, satellites);
        out += body;
    }
    return out;
}

namespace {

std::string number(double x) { return fmt::format("{:19.12E}", x); }

void rows(std::string& out, const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); i += 4) {
        out += "    ";
        for (std::size_t k = i; k < std::min(i + 4, values.size()); ++k) out += number(values[k]);
        out += '\n';
    }
}

void satellite_line(std::string& out, gnss::SatelliteId s, Time reference, double a, double b, double c) {
    Stamp t = stamp_of(reference - gnss::lag_of(s.system));
    if (s.system == System::Glonass) {
        const Calendar utc = utc_from_gps(reference);
        t = {utc, static_cast<int>(utc.second + 0.5), 0};
    }
    out += fmt::format("{} {:4} {:02} {:02} {:02} {:02} {:02}{}{}{}\n", gnss::name_of(s), t.day.year, t.day.month, t.day.day,
                       t.day.hour, t.day.minute, t.second, number(a), number(b), number(c));
}

std::string record(const gnss::KeplerEphemeris& k) {
    std::string out;
    const System system = k.satellite.system;
    satellite_line(out, k.satellite, k.toc, k.af0, k.af1, k.af2);
    // Galileo weeks are written as GPS weeks, BeiDou weeks by its own count
    const auto [gps_week, toe] = gnss::week_second(k.toe, system);
    const double week = gps_week - (system == System::BeiDou ? gnss::first_week_of(system) : 0);
    // in seconds of the week of toe: negative if transmitted before
    const double sent = toe + (k.transmission - k.toe).seconds();
    const bool galileo = system == System::Galileo, gps = system == System::Gps || system == System::Qzss;
    constexpr double inav_e1 = 513.0, fnav = 258.0;
    const double sources = galileo ? (k.message == gnss::NavMessage::Fnav ? fnav : inav_e1) : gps ? 1.0 : 0.0;
    rows(out, {static_cast<double>(k.iode),
               k.crs,
               k.delta_n,
               k.m0,
               k.cuc,
               k.e,
               k.cus,
               k.sqrt_a,
               toe,
               k.cic,
               k.omega0,
               k.cis,
               k.i0,
               k.crc,
               k.omega,
               k.omega_dot,
               k.idot,
               sources,
               week,
               0.0,
               k.accuracy,
               static_cast<double>(k.health),
               k.group_delay[0],
               gps ? static_cast<double>(k.iodc) : k.group_delay[1],
               sent,
               gps                        ? k.fit_interval / 3600.0
               : system == System::BeiDou ? static_cast<double>(k.iodc)
                                          : 0.0});
    return out;
}

template <class StateVector>
std::string state_record(const StateVector& g, double sent, const std::array<double, 3>& last) {
    std::string out;
    constexpr double km = 1e-3;
    satellite_line(out, g.satellite, g.toe, g.clock, g.clock_rate, sent);
    std::vector<double> values;
    for (Eigen::Index i = 0; i < 3; ++i) {
        for (const double x : {g.position[i] * km, g.velocity[i] * km, g.acceleration[i] * km, last[static_cast<std::size_t>(i)]})
            values.push_back(x);
    }
    rows(out, values);
    return out;
}

}  // namespace

std::string rinex_navigation_text(const gnss::Navigation& n) {
    std::string out;
    line(out, "     3.04           N: GNSS NAV DATA    M: MIXED", "RINEX VERSION / TYPE");
    line(out, "schuler", "PGM / RUN BY / DATE");
    constexpr std::array<std::string_view, gnss::system_count> names = {"GPS", "", "", "BDS", "QZS", "", "IRN"};
    if (n.galileo_ionosphere) {
        const auto& a = n.galileo_ionosphere->a;
        line(out, fmt::format("GAL  {:12.4E}{:12.4E}{:12.4E}{:12.4E}", a[0], a[1], a[2], 0.0), "IONOSPHERIC CORR");
    }
    for (std::size_t i = 0; i < n.klobuchar.size(); ++i) {
        if (!n.klobuchar[i]) continue;
        for (const auto& [letter, k] : {std::pair('A', n.klobuchar[i]->alpha), std::pair('B', n.klobuchar[i]->beta)})
            line(out, fmt::format("{}{} {:12.4E}{:12.4E}{:12.4E}{:12.4E}", names[i], letter, k[0], k[1], k[2], k[3]),
                 "IONOSPHERIC CORR");
    }
    if (n.leap_seconds) line(out, fmt::format("{:6}", *n.leap_seconds), "LEAP SECONDS");
    line(out, "", "END OF HEADER");
    std::vector<std::tuple<Time, gnss::SatelliteId, std::string>> records;
    for (const auto& k : n.kepler)  // the format has no record for CNAV before version 4
        if (k.message != gnss::NavMessage::Cnav) records.emplace_back(k.toc, k.satellite, record(k));
    for (const auto& g : n.glonass) {
        // in the week of UTC
        const Duration leap{std::int64_t{gps_minus_utc(g.transmission.ns / detail::ns_per_second)} * detail::ns_per_second};
        const double sent = gnss::week_second(g.transmission - leap).second;
        records.emplace_back(
            g.toe, g.satellite,
            state_record(g, sent,
                         {static_cast<double>(g.health), static_cast<double>(g.channel), static_cast<double>(g.age_days)}));
    }
    for (const auto& g : n.sbas)
        records.emplace_back(
            g.toe, g.satellite,
            state_record(g, gnss::week_second(g.transmission).second, {static_cast<double>(g.health), g.accuracy, 0.0}));
    std::ranges::stable_sort(records, [](const auto& a, const auto& b) {
        return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
    });
    for (const auto& entry : records) out += std::get<2>(entry);
    return out;
}

}  // namespace schuler::io
