#include "schuler/gnss/ranges.h"

#include "schuler/earth/ellipsoid.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace schuler::gnss {
namespace {

/// Bands in order of preference. BeiDou's B1C and B2a require group delays not transmitted in its D1 and D2 messages.
std::string_view bands_of(System system) {
    switch (system) {
        case System::Glonass: return "12";
        case System::Galileo: return "1578";
        case System::BeiDou: return "267";
        case System::Sbas: return "1";
        case System::Navic: return "5";
        default: return "125";
    }
}

/// Tracking modes in order of preference: open codes before encrypted ones.
constexpr std::string_view attributes = "CIXSLBQPWZAYMND";

/// The best observation with a pseudorange in one band of one satellite.
const SignalObservation* best_in_band(std::span<const SignalObservation> of_satellite, char band, double least_cn0) {
    const SignalObservation* best = nullptr;
    std::size_t rank = 0;
    for (const SignalObservation& o : of_satellite) {
        if (o.signal.band != band || !(o.pseudorange > 1e6 && o.pseudorange < 1e9) || o.cn0 < least_cn0) continue;
        const std::size_t r = attributes.find(o.signal.attribute);
        if (best == nullptr || r < rank) {
            best = &o;
            rank = r;
        }
    }
    return best;
}

/// First and second signal of a satellite; null if there is none.
std::array<const SignalObservation*, 2> signals_of(std::span<const SignalObservation> of_satellite, double least_cn0) {
    std::array<const SignalObservation*, 2> found{nullptr, nullptr};
    std::size_t n = 0;
    for (const char band : bands_of(of_satellite.front().satellite.system)) {
        const SignalObservation* o = best_in_band(of_satellite, band, least_cn0);
        if (o != nullptr && n < 2) found[n++] = o;
    }
    return found;
}

/// Satellite at the time of transmission, from the time tag and the pseudorange.
std::optional<Transmitter> transmitter_of(const SatelliteSource& source, const SignalObservation& o, Time tag, Time& transmit) {
    const Time sent = tag - Duration::from_seconds(o.pseudorange / speed_of_light);
    const auto first = source.at(o.satellite, o.signal, sent);
    if (!first) return std::nullopt;
    transmit = sent - Duration::from_seconds(first->state.clock);
    return source.at(o.satellite, o.signal, transmit);
}

int channel_of(SatelliteId s, const GlonassChannels& channels, int broadcast) {
    const std::int8_t known = channels.of_slot[s.number];
    return s.system == System::Glonass && known != unknown_channel ? known : broadcast;
}

}  // namespace

std::size_t clock_of(System system) {
    switch (system) {
        case System::Glonass: return 1;
        case System::Galileo: return 2;
        case System::BeiDou: return 3;
        case System::Navic: return 4;
        default: return 0;
    }
}

void prepare_ranges(std::span<const SignalObservation> observations, Time tag, const SatelliteSource& source,
                    const GlonassChannels& channels, const RangeSettings& settings, std::vector<Range>& out) {
    out.clear();
    for (std::size_t first = 0, last = 0; first < observations.size(); first = last) {
        const SatelliteId id = observations[first].satellite;
        while (last < observations.size() && observations[last].satellite == id) ++last;
        if (!settings.systems[static_cast<std::size_t>(id.system)]) continue;
        const auto [a, b] = signals_of(observations.subspan(first, last - first), settings.least_cn0);
        const bool dual = settings.ionosphere == IonosphereModel::Dual;
        if (a == nullptr || (dual && b == nullptr)) continue;
        Range r;
        const auto t = transmitter_of(source, *a, tag, r.transmit);
        if (!t) continue;
        r.satellite = id;
        r.signal = a->signal;
        r.cn0 = a->cn0;
        r.position = t->state.position;
        r.velocity = t->state.velocity;
        // GLONASS uses many frequencies, each with its own delay in the receiver
        constexpr double interfrequency = 1.5;  // m, one sigma
        r.variance = t->state.variance + (id.system == System::Glonass ? interfrequency * interfrequency : 0.0);
        const int channel = channel_of(id, channels, t->channel);
        r.frequency = frequency_of(id.system, a->signal.band, channel);
        double code = a->pseudorange - speed_of_light * t->group_delay;
        if (dual) {
            const auto second = source.at(id, b->signal, r.transmit);
            const double fb = frequency_of(id.system, b->signal.band, channel), g = r.frequency * r.frequency / (fb * fb);
            const double code_b = b->pseudorange - speed_of_light * (second ? second->group_delay : 0.0);
            code = (g * code - code_b) / (g - 1.0);
            r.noise = std::sqrt(g * g + 1.0) / std::abs(g - 1.0);
        }
        r.pseudorange = code + speed_of_light * t->state.clock;
        if (std::isfinite(a->doppler)) {
            r.range_rate = -a->doppler * speed_of_light / r.frequency + speed_of_light * t->state.clock_rate;
        }
        if (std::isfinite(a->phase) && a->phase != 0.0)
            r.phase = a->phase * speed_of_light / r.frequency + speed_of_light * t->state.clock;
        r.phase_lost = (a->loss_of_lock & 1U) != 0;
        r.half_cycle = (a->loss_of_lock & 2U) != 0;
        if (dual) r.frequency = 0.0;
        out.push_back(r);
    }
}

double noise_factor(double elevation, double cn0) {
    const double s = std::max(std::sin(elevation), 0.05);
    const double weak = std::isfinite(cn0) && cn0 > 0.0 && cn0 < 45.0 ? std::pow(10.0, (45.0 - cn0) / 20.0) : 1.0;
    return std::sqrt(0.5 + 0.5 / (s * s)) * weak;
}

AtmosphericDelay atmospheric_delay(Time transmit, System system, double frequency, const Geodetic& receiver, Direction direction,
                                   const BroadcastIonosphere* ionosphere, const RangeSettings& settings) {
    AtmosphericDelay out;
    if (settings.ionosphere == IonosphereModel::Broadcast && ionosphere != nullptr && frequency > 0.0) {
        const IonosphericDelay d = ionospheric_delay(*ionosphere, system, frequency, transmit, receiver, direction);
        out.delay = d.delay;
        out.variance = d.sigma * d.sigma;
    }
    if (settings.troposphere == TroposphereModel::Saastamoinen) {
        const ZenithDelay zenith = saastamoinen_zenith(receiver, settings.relative_humidity);
        out.delay += troposphere_delay(zenith, settings.mapping, transmit, receiver, direction.elevation);
        const double rest = 0.1 / std::max(std::sin(direction.elevation), 0.05);
        out.variance += rest * rest;
    }
    return out;
}

ModelledRange model_range(const Range& r, const Ecef& receiver, const Geodetic& geodetic, const BroadcastIonosphere* ionosphere,
                          const RangeSettings& settings) {
    ModelledRange m;
    const Eigen::Vector3d apart = receiver.r - r.position.r;
    const double distance = apart.norm();
    // the Earth rotates during the light time: closed form of rotating the satellite by w tau
    const double w_c = earth::wgs84.w_ie / speed_of_light;
    const double sagnac = w_c * (r.position.r.x() * receiver.r.y() - r.position.r.y() * receiver.r.x());
    const double angle = w_c * distance;
    const Eigen::Vector3d turned(r.position.r.x() + angle * r.position.r.y(), r.position.r.y() - angle * r.position.r.x(),
                                 r.position.r.z());
    m.line_of_sight = (receiver.r - turned).normalized();
    m.range = distance + sagnac;
    m.direction = direction_to({turned}, receiver, geodetic);
    const double code = r.sigma > 0.0 ? r.sigma : settings.code_sigma * r.noise * noise_factor(m.direction.elevation, r.cn0);
    const AtmosphericDelay air =
        atmospheric_delay(r.transmit, r.satellite.system, r.frequency, geodetic, m.direction, ionosphere, settings);
    m.range += air.delay;
    m.slow_variance = r.variance + (r.slow > 0.0 ? r.slow * r.slow : air.variance);
    m.variance = code * code + m.slow_variance;
    return m;
}

double model_range_rate(const Range& r, const Ecef& receiver, const Eigen::Vector3d& v) {
    // the derivative of distance + Sagnac term as in model_range, and of the light time: the satellite's own time is slower by
    // the range rate
    const double w_c = earth::wgs84.w_ie / speed_of_light;
    const Eigen::Vector3d &s = r.position.r, &vs = r.velocity;
    const Eigen::Vector3d u = (receiver.r - s).normalized();
    const double simple =
        u.dot(v - vs) + w_c * (vs.x() * receiver.r.y() - vs.y() * receiver.r.x() + s.x() * v.y() - s.y() * v.x());
    return simple / (1.0 - u.dot(vs) / speed_of_light);
}

double range_rate_sigma(const Range& r, double elevation, const RangeSettings& settings) {
    return r.sigma_rate > 0.0 ? r.sigma_rate : settings.doppler_sigma * noise_factor(elevation, r.cn0);
}

}  // namespace schuler::gnss
