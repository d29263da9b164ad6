#include "schuler/gnss/constellation.h"

#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/atmosphere.h"
#include "schuler/gnss/orbit.h"
#include "schuler/gnss/system_time.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace schuler::gnss {
namespace {

using units::deg;
constexpr double greenwich = 277.85 * deg;  ///< right ascension at the start of the week

/// A plane of GPS's nominal constellation: right ascension of the node and arguments of latitude, degrees.
struct Plane {
    double node;
    std::array<double, 4> latitude;
};
constexpr std::array<Plane, 6> gps_planes{{{272.847, {268.126, 161.786, 11.676, 41.806}},
                                           {332.847, {80.956, 173.336, 309.976, 204.376}},
                                           {32.847, {111.876, 11.796, 339.666, 241.556}},
                                           {92.847, {135.226, 265.446, 35.156, 167.356}},
                                           {152.847, {197.046, 302.596, 66.066, 333.686}},
                                           {212.847, {238.886, 345.226, 105.206, 135.346}}}};

}  // namespace

Navigation nominal_gps(Time from, Time to) {
    constexpr double a = 26'559'710.0, mu = 3.986005e14;
    constexpr Duration every{7'200'000'000'000};
    const double n = std::sqrt(mu / (a * a * a));
    Navigation out;
    for (Time toe{from.ns - from.ns % every.ns}; toe < to + every; toe = toe + every) {
        std::uint8_t number = 0;
        for (const Plane& plane : gps_planes) {
            for (const double latitude : plane.latitude) {
                KeplerEphemeris k;
                k.satellite = {System::Gps, ++number};
                k.toe = k.toc = k.transmission = toe;
                k.sqrt_a = std::sqrt(a);
                k.i0 = 55.0 * deg;
                // relative to the start of the week of `from`, so that a scenario may extend into the next week
                const double since = week_second(from).second + (toe - from).seconds();
                k.omega0 = plane.node * deg - greenwich - gps_earth_rate * (since - week_second(toe).second);
                k.m0 = std::remainder(latitude * deg + n * since, 2.0 * std::numbers::pi);
                k.iode = k.iodc = static_cast<int>(week_second(toe).second / 7200.0) % 256;
                k.accuracy = 0.01;
                out.kepler.push_back(k);
            }
        }
    }
    return out;
}

Navigation nominal_glonass(Time from, Time to) {
    constexpr double a = 25'508e3, mu = 3.986004418e14, inclination = 64.8 * deg;
    constexpr Duration every{1'800'000'000'000};
    const Time first{from.ns - from.ns % every.ns};
    const double n = std::sqrt(mu / (a * a * a)), since = week_second(from).second - (from - first).seconds();
    constexpr std::array<int, 24> channels{1, -4, 5, 6, 1, -4, 5, 6, -2, -7, 0, -1, -2, -7, 0, -1, 4, -3, 3, 2, 4, -3, 3, 2};
    Navigation out;
    for (std::uint8_t slot = 0; slot < 24; ++slot) {
        const int plane = slot / 8;
        const double node = 120.0 * deg * plane + 30.0 * deg - greenwich - gps_earth_rate * since;
        const double u = (45.0 * (slot % 8) + 15.0 * plane) * deg + n * since;
        const double cu = std::cos(u), su = std::sin(u), ci = std::cos(inclination), si = std::sin(inclination);
        const double cn = std::cos(node), sn = std::sin(node);
        const auto level = [&](double x, double y) {
            return Eigen::Vector3d(cn * x - sn * ci * y, sn * x + cn * ci * y, si * y);
        };
        GlonassEphemeris g;
        g.satellite = {System::Glonass, static_cast<std::uint8_t>(slot + 1)};
        g.channel = channels[slot];
        g.toe = g.transmission = first;
        g.position = a * level(cu, su);
        const Eigen::Vector3d inertial = a * n * level(-su, cu);
        g.velocity = inertial + gps_earth_rate * Eigen::Vector3d(g.position.y(), -g.position.x(), 0.0);
        for (;;) {
            out.glonass.push_back(g);
            if (g.toe > to) break;
            const SatelliteState next = satellite_state(g, g.toe + every);
            g.position = next.position.r;
            g.velocity = next.velocity;
            g.toe = g.transmission = g.toe + every;
        }
    }
    std::ranges::stable_sort(out.glonass, {}, &GlonassEphemeris::toe);
    return out;
}

std::vector<Sighting> satellites_in_view(const SatelliteSource& source, std::span<const SatelliteId> among, Time t,
                                         const Ecef& receiver, double mask) {
    const Geodetic place = earth::geodetic_from_ecef(earth::wgs84, receiver);
    std::vector<Sighting> out;
    for (const SatelliteId id : among) {
        const auto found = source.at(id, {}, t);
        if (!found) continue;
        const double elevation = direction_to(found->state.position, receiver, place).elevation;
        if (elevation > mask) out.push_back({id, elevation, (receiver.r - found->state.position.r).normalized()});
    }
    std::ranges::stable_sort(out, std::greater<>{}, &Sighting::elevation);
    return out;
}

double pdop(std::span<const Sighting> sightings) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (sightings.size() < 4) return infinite;
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    for (const Sighting& s : sightings) {
        const Eigen::Vector4d row(s.line_of_sight.x(), s.line_of_sight.y(), s.line_of_sight.z(), 1.0);
        normal += row * row.transpose();
    }
    const Eigen::FullPivLU<Eigen::Matrix4d> lu(normal);
    if (lu.rank() < 4) return infinite;
    return std::sqrt(lu.inverse().topLeftCorner<3, 3>().trace());
}

std::vector<std::size_t> best_four(std::span<const Sighting> s) {
    std::vector<std::size_t> best;
    for (std::size_t i = 0; i < std::min<std::size_t>(4, s.size()); ++i) best.push_back(i);
    double least = std::numeric_limits<double>::infinity();
    const std::size_t n = s.size();
    for (std::size_t a = 0; a + 3 < n; ++a)
        for (std::size_t b = a + 1; b + 2 < n; ++b)
            for (std::size_t c = b + 1; c + 1 < n; ++c)
                for (std::size_t d = c + 1; d < n; ++d) {
                    const double value = pdop(std::array{s[a], s[b], s[c], s[d]});
                    if (value >= least) continue;
                    least = value;
                    best = {a, b, c, d};
                }
    return best;
}

std::vector<SatelliteId> satellites_of(const Navigation& navigation) {
    std::set<SatelliteId> found;
    for (const KeplerEphemeris& k : navigation.kepler) found.insert(k.satellite);
    for (const GlonassEphemeris& g : navigation.glonass) found.insert(g.satellite);
    for (const SbasEphemeris& g : navigation.sbas) found.insert(g.satellite);
    return {found.begin(), found.end()};
}

}  // namespace schuler::gnss
