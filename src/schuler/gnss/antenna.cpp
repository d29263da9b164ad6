#include "schuler/gnss/antenna.h"

#include "schuler/core/units.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::gnss {
namespace {

constexpr double whole_turn = 2.0 * std::numbers::pi;

/// Place on a uniform grid of `count` nodes: the left node and the part of the way to the next.
struct GridPlace {
    std::size_t left;
    double part;
};
GridPlace place_on(double x, std::size_t count) {
    const double inside = std::clamp(x, 0.0, static_cast<double>(count - 1));
    const auto left = std::min(static_cast<std::size_t>(inside), count < 2 ? 0 : count - 2);
    return {left, inside - static_cast<double>(left)};
}

/// "TYPE            RADO" without trailing blanks.
std::string_view without_blanks(std::string_view text) { return text.substr(0, text.find_last_not_of(' ') + 1); }

}  // namespace

double PhasePattern::at(double zenith, double azimuth) const {
    if (rows.empty() || rows.front().empty() || !(step > 0.0)) return 0.0;
    const auto along = [&](const std::vector<double>& row) {
        const GridPlace p = place_on((zenith - first) / step, row.size());
        return row.size() < 2 ? row.front() : (1.0 - p.part) * row[p.left] + p.part * row[p.left + 1];
    };
    if (rows.size() == 1) return along(rows.front());
    const double turned = azimuth - whole_turn * std::floor(azimuth / whole_turn);
    const GridPlace p = place_on(turned / whole_turn * static_cast<double>(rows.size() - 1), rows.size());
    return (1.0 - p.part) * along(rows[p.left]) + p.part * along(rows[p.left + 1]);
}

const AntennaCarrier* Antenna::on(double frequency) const {
    const auto nearest =
        std::ranges::min_element(carriers, {}, [&](const AntennaCarrier& c) { return std::abs(c.frequency - frequency); });
    return nearest == carriers.end() ? nullptr : &*nearest;
}

double Antenna::to_reference_point(double frequency, Direction d) const {
    const AntennaCarrier* carrier = on(frequency);
    if (carrier == nullptr) return 0.0;
    const Eigen::Vector3d towards(std::cos(d.elevation) * std::cos(d.azimuth), std::cos(d.elevation) * std::sin(d.azimuth),
                                  std::sin(d.elevation));
    return carrier->offset.dot(towards) - carrier->variation.at(0.5 * std::numbers::pi - d.elevation, d.azimuth);
}

const Antenna* Antennas::of_receiver(std::string_view type) const {
    const auto named = [&](std::string_view name) -> const Antenna* {
        const auto it = std::ranges::find_if(receivers, [&](const Antenna& a) { return without_blanks(a.type) == name; });
        return it == receivers.end() ? nullptr : &*it;
    };
    constexpr std::size_t radome = 16;  // its column
    const std::string_view name = without_blanks(type);
    if (name.empty()) return nullptr;
    if (const Antenna* found = named(name)) return found;
    std::string bare(without_blanks(name.substr(0, radome)));
    if (const Antenna* found = named(bare)) return found;
    bare.resize(radome, ' ');
    return named(bare + "NONE");
}

const Antenna* Antennas::of_satellite(SatelliteId satellite, Time t) const {
    const auto it = std::ranges::find_if(
        satellites, [&](const SatelliteAntenna& a) { return a.satellite == satellite && a.from <= t && t <= a.until; });
    return it == satellites.end() ? nullptr : &it->antenna;
}

Eigen::Vector3d direction_of_sun(Time t) {
    constexpr double deg = units::deg, day = 86'400.0;
    // days of dynamical time, and of universal time, since 2000-01-01 12:00; GPS time begins 1980-01-06, 7300.5 days earlier
    constexpr double since_1980 = 7300.5, tt_minus_gps = 51.184;  // days; s
    const Calendar utc = utc_from_gps(t);
    const double seconds = static_cast<double>(gps_from_calendar(utc).ns) * 1e-9;
    const double n = (t.seconds() + tt_minus_gps) / day - since_1980, ut = seconds / day - since_1980;
    const double mean = 280.460 + 0.9856474 * n, anomaly = (357.528 + 0.9856003 * n) * deg;
    const double longitude = (mean + 1.915 * std::sin(anomaly) + 0.020 * std::sin(2.0 * anomaly)) * deg;
    const double obliquity = (23.439 - 4e-7 * n) * deg;
    const Eigen::Vector3d equatorial(std::cos(longitude), std::cos(obliquity) * std::sin(longitude),
                                     std::sin(obliquity) * std::sin(longitude));
    const double sidereal = std::fmod(280.46061837 + 360.98564736629 * ut, 360.0) * deg;
    const double c = std::cos(sidereal), s = std::sin(sidereal);
    return {c * equatorial.x() + s * equatorial.y(), -s * equatorial.x() + c * equatorial.y(), equatorial.z()};
}

Eigen::Vector3d satellite_phase_centre(const Antenna& antenna, double frequency, const Ecef& satellite, Time t) {
    const AntennaCarrier* carrier = antenna.on(frequency);
    if (carrier == nullptr) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d z = -satellite.r.normalized(), y = z.cross(direction_of_sun(t)).normalized(), x = y.cross(z);
    return carrier->offset.x() * x + carrier->offset.y() * y + carrier->offset.z() * z;
}

}  // namespace schuler::gnss
