#include "schuler/io/detail/bits.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/receiver/detail/rtcm3_messages.h"

#include <array>
#include <cmath>
#include <string>

namespace schuler::io::detail {
namespace {

using gnss::Signal;
using gnss::System;

/// Sizes of fields that differ between the systems, and the signals of their code indicators.
struct LegacySystem {
    std::size_t time, range, ambiguity;
    double modulus;  ///< m
    std::array<Signal, 2> first;
    std::array<Signal, 4> second;
};
constexpr LegacySystem fields_of_gps{
    30, 24, 8, metres_per_ms, {{{'1', 'C'}, {'1', 'P'}}}, {{{'2', 'X'}, {'2', 'P'}, {'2', 'D'}, {'2', 'W'}}}};
constexpr LegacySystem fields_of_glonass{
    27, 25, 7, 2.0 * metres_per_ms, {{{'1', 'C'}, {'1', 'P'}}}, {{{'2', 'C'}, {'2', 'P'}, {'2', 'C'}, {'2', 'P'}}}};

constexpr double metres_of_range = 0.02, metres_of_phase = 0.0005, db_of_cn0 = 0.25;

/// One carrier: its range and phase minus the first range.
struct LegacyCarrier {
    Signal signal;
    double range = NAN, phase = NAN, cn0 = NAN;  ///< m, m, dB-Hz
    int lock = 0;
};

}  // namespace

double LegacyObservations::continued(gnss::SatelliteId satellite, Signal signal, double cycles) {
    // The field has room for 1500 cycles of phase minus code, which grows with the ionosphere: senders then begin anew.
    constexpr double room = 1500.0;
    double& last = cycles_.try_emplace({satellite, signal}, cycles).first->second;
    last = cycles + room * std::round((last - cycles) / room);
    return last;
}

Decoded LegacyObservations::read(std::string_view payload, int number, Time now, gnss::GlonassChannels& channels,
                                 MeasuredEpoch& out) {
    const bool of_glonass = number > 1008, two = number == 1004 || number == 1012;
    if (number % 2 != 0) return Decoded::Foreign;
    const LegacySystem& system = of_glonass ? fields_of_glonass : fields_of_gps;
    Bits bits(payload);
    bits.skip(24);
    const auto time = bits.take(system.time);
    out.time = of_glonass ? nearest_in_moscow_day(static_cast<std::int64_t>(time) * 1'000'000, now)
                          : nearest_in_week(static_cast<double>(time) * 1e-3, now, System::Gps);
    out.more = bits.take(1) != 0;
    const int satellites = bits.integer(5);
    bits.skip(4);
    for (int i = 0; i < satellites; ++i) {
        const int id = bits.integer(6);
        LegacyCarrier first, second;
        first.signal = system.first[bits.take(1)];
        gnss::SatelliteId satellite{of_glonass ? System::Glonass : System::Gps, static_cast<std::uint8_t>(id)};
        constexpr int first_sbas = 40;  // PRN 120
        if (!of_glonass && id >= first_sbas) satellite = {System::Sbas, static_cast<std::uint8_t>(id - first_sbas + 20)};
        if (of_glonass) {
            const int channel = bits.integer(5) - 7;
            if (channel <= 6) channels.of_slot[satellite.number] = static_cast<std::int8_t>(channel);
        }
        first.range = static_cast<double>(bits.take(system.range)) * metres_of_range;
        first.phase = metres_of_phase * field_or_none(bits, 20);
        first.lock = bits.integer(7);
        first.range += static_cast<double>(bits.take(system.ambiguity)) * system.modulus;
        first.cn0 = static_cast<double>(bits.take(8)) * db_of_cn0;
        if (two) {
            second.signal = system.second[bits.take(2)];
            second.range = first.range + metres_of_range * field_or_none(bits, 14);
            second.phase = metres_of_phase * field_or_none(bits, 20);
            second.lock = bits.integer(7);
            second.cn0 = static_cast<double>(bits.take(8)) * db_of_cn0;
        }
        if (!bits.ok()) return Decoded::Damaged;
        if (id == 0) continue;
        const std::int8_t channel = of_glonass ? channels.of_slot[satellite.number] : std::int8_t{0};
        for (const LegacyCarrier& c : {first, second}) {
            if (!std::isfinite(c.range) && !std::isfinite(c.phase)) continue;
            gnss::SignalObservation o;
            o.satellite = satellite;
            o.signal = c.signal;
            if (std::isfinite(c.range)) o.pseudorange = c.range;
            const double per_metre = channel == gnss::unknown_channel
                                         ? NAN
                                         : gnss::frequency_of(satellite.system, c.signal.band, channel) / gnss::speed_of_light;
            if (std::isfinite(c.phase) && per_metre > 0.0)
                o.phase = first.range * per_metre + continued(satellite, c.signal, c.phase * per_metre);
            if (c.cn0 > 0.0) o.cn0 = c.cn0;
            out.observations.push_back(o);
            out.locks.push_back(c.lock);
        }
    }
    return Decoded::Used;
}

Decoded rtcm3_station(std::string_view payload, int number, gnss::ObservationLog& log) {
    Bits bits(payload);
    bits.skip(24);
    if (number == 1005 || number == 1006) {
        bits.skip(10);  // year of realization, systems, kind of station
        Eigen::Vector3d place;
        for (int i = 0; i < 3; ++i) {
            place[i] = static_cast<double>(bits.take_signed(38)) * 1e-4;
            if (i < 2) bits.skip(2);
        }
        if (!bits.ok()) return Decoded::Damaged;
        constexpr double earth_inside = 6e6;  // m: zeros where the place is not set
        if (place.norm() < earth_inside) return Decoded::Used;
        log.approximate.r = place;  // of the antenna itself
        log.antenna_delta.setZero();
        return Decoded::Used;
    }
    if (number != 1007 && number != 1008 && number != 1033) return Decoded::Foreign;
    std::string type;
    for (int left = bits.integer(8); left > 0 && bits.ok(); --left) type += static_cast<char>(bits.take(8));
    if (!bits.ok()) return Decoded::Damaged;
    log.antenna = std::move(type);
    return Decoded::Used;
}

}  // namespace schuler::io::detail
