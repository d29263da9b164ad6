// Logs of receivers under a nominal sky, with errors that are put in: tests without any data set.
#pragma once

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/constellation.h"
#include "schuler/math/random.h"
#include "schuler/ppk/air_delay.h"
#include "schuler/ppk/solve.h"

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace schuler::ppk::test {

constexpr double deg = 0.017453292519943295;

/// GPS, and 24 more satellites between them that are called Galileo's.
inline gnss::Navigation made_up_sky(Time from, Time to) {
    gnss::Navigation sky = gnss::nominal_gps(from, to);
    const std::vector<gnss::KeplerEphemeris> gps = sky.kepler;
    for (gnss::KeplerEphemeris k : gps) {
        k.satellite.system = gnss::System::Galileo;
        k.message = gnss::NavMessage::Inav;
        k.m0 += 0.55;
        k.omega0 += 0.4;
        sky.kepler.push_back(k);
    }
    return sky;
}

/// How a receiver measures.
struct Receiver {
    std::string systems = "GE";
    double code_sigma = 0.5, code_correlation = 60.0, phase_sigma = 0.003;  ///< at the zenith, m, s, m
    double phase_reflections = 0.0, phase_correlation = 30.0;               ///< at the zenith, m, s
    double outliers = 0.0;  ///< share of the time in which a code is metres too long
    double interval = 1.0;  ///< s
    std::function<double(Time)> clock = [](Time t) {
        return 2e-5 + 1e-8 * (t.seconds() - std::floor(t.seconds() / 1e5) * 1e5);
    };  ///< s
    std::function<Ecef(Time)> place;
    std::function<double(SatelliteId, double)> vertical_ionosphere = [](SatelliteId, double) {
        return 0.0;
    };                          ///< m on L1, of time in s from the start
    double zenith_delay = 0.0;  ///< m beyond the model's
    bool air = false;           ///< the model's troposphere
    /// North, east, up from `place` to where a carrier is received, m.
    std::function<Eigen::Vector3d(double)> phase_centre = [](double) { return Eigen::Vector3d(0, 0, 0); };
    /// And by how much its phase is longer, m, by elevation.
    std::function<double(double)> variation = [](double) { return 0.0; };
};

/// Its log from `from` for so many seconds.
inline gnss::ObservationLog measured(const gnss::Navigation& sky, const Receiver& receiver, Time from, double seconds,
                                     std::uint64_t seed) {
    const gnss::BroadcastSource source(sky);
    math::Random random(seed, "receiver");
    gnss::ObservationLog log;
    log.approximate = receiver.place(from);
    log.antenna_delta.setZero();
    struct Channel {
        double reflections = 0, phase = 0, outlier = 0, cycles = 0;
        bool begun = false;
    };
    std::map<std::pair<SatelliteId, char>, Channel> channels;
    const auto satellites = gnss::satellites_of(sky);
    const double rho = receiver.code_correlation > 0.0 ? std::exp(-receiver.interval / receiver.code_correlation) : 0.0;
    for (double t = 0.0; t <= seconds; t += receiver.interval) {
        const Time tag = from + Duration::from_seconds(t);
        const double clock = receiver.clock(tag);
        const Time true_time = tag - Duration::from_seconds(clock);
        const Ecef place = receiver.place(true_time);
        const Geodetic geodetic = earth::geodetic_from_ecef(earth::wgs84, place);
        gnss::ObservationEpoch epoch;
        epoch.time = tag;
        epoch.first = log.observations.size();
        for (const SatelliteId id : satellites) {
            if (receiver.systems.find(gnss::letter_of(id.system)) == std::string::npos) continue;
            TrackedSatellite s;
            s.id = id;
            double flight = 0.075;
            Line line;
            for (int i = 0; i < 5; ++i) {
                // nanoseconds are a micrometre of orbit; the rest goes into the range by the satellite's velocity
                s.transmit = true_time - Duration::from_seconds(flight);
                const auto found = source.at(id, {'1', 'C'}, s.transmit);
                if (!found) break;
                s.position = found->state.position;
                line = line_to(s, place, geodetic);
                flight = line.range / gnss::speed_of_light;
            }
            if (line.range == 0.0 || line.direction.elevation < 5.0 * deg) continue;
            const std::string bands = id.system == gnss::System::Gps ? "12" : "15";
            const double factor = gnss::noise_factor(line.direction.elevation, 45.0);
            AirModel air;
            const double troposphere = (receiver.air ? air_delay(air, s, geodetic, line.direction).troposphere : 0.0) +
                                       receiver.zenith_delay / std::sin(line.direction.elevation);
            const double ionosphere =
                receiver.vertical_ionosphere(id, t) / std::sqrt(1.0 - std::pow(0.948 * std::cos(line.direction.elevation), 2));
            for (const char band : bands) {
                Channel& c = channels[{id, band}];
                const double wavelength = gnss::speed_of_light / gnss::frequency_of(id.system, band);
                const double spread = receiver.code_sigma * factor;
                c.reflections = c.begun ? rho * c.reflections + std::sqrt(1.0 - rho * rho) * spread * random.normal()
                                        : spread * random.normal();
                if (!c.begun) c.cycles = std::floor(1e6 * random.uniform());
                c.begun = true;
                const double rho_phase = std::exp(-receiver.interval / receiver.phase_correlation),
                             of_phase = receiver.phase_reflections * factor;
                if (of_phase > 0.0)
                    c.phase = rho_phase * c.phase + std::sqrt(1.0 - rho_phase * rho_phase) * of_phase * random.normal();
                constexpr double lasting = 20.0;  // s
                if (receiver.outliers > 0.0 && random.uniform() < receiver.interval / lasting)
                    c.outlier = random.uniform() < receiver.outliers ? 3.0 + 30.0 * random.uniform() : 0.0;
                gnss::SignalObservation o;
                o.satellite = id;
                o.signal = {band, band == '1' ? 'C' : 'X'};
                const Eigen::Vector3d centre = receiver.phase_centre(gnss::speed_of_light / wavelength);
                const Ecef received{place.r +
                                    earth::C_en(geodetic.lat, geodetic.lon) * Eigen::Vector3d(centre[0], centre[1], -centre[2])};
                const double range = line_to(s, received, geodetic).range + receiver.variation(line.direction.elevation);
                const double modelled = range + gnss::speed_of_light * clock + troposphere,
                             g = ionosphere_factor(wavelength) * ionosphere;
                o.pseudorange = modelled + g + c.reflections + c.outlier;
                o.phase = (modelled - g + c.phase + receiver.phase_sigma * factor * random.normal()) / wavelength + c.cycles;
                o.cn0 = 45.0;
                log.observations.push_back(o);
            }
        }
        epoch.count = log.observations.size() - epoch.first;
        log.epochs.push_back(epoch);
    }
    return log;
}

inline Ecef place_from(const Geodetic& origin, double north, double east, double up) {
    const Ecef o = earth::ecef_from_geodetic(earth::wgs84, origin);
    return {o.r + earth::C_en(origin.lat, origin.lon) * Eigen::Vector3d(north, east, -up)};
}

}  // namespace schuler::ppk::test
