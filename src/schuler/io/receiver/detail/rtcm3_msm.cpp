#include "schuler/io/detail/bits.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/receiver/detail/rtcm3_messages.h"

#include <array>
#include <cmath>

namespace schuler::io::detail {
namespace {

using gnss::Signal;
using gnss::System;

struct Family {
    System system;
    /// Signals of mask places 1 to 32, two characters each, dots where reserved [RTCM10403:tables 3.5-91 to 3.5-108].
    std::string_view signals;
};

std::optional<Family> family_of(int number) {
    switch (number / 10) {
        case 107: return Family{System::Gps, "..1C1P1W......2C2P2W........2S2L2X........5I5Q5X..........1S1L1X"};
        case 108: return Family{System::Glonass, "..1C1P........2C2P.............................................."};
        case 109: return Family{System::Galileo, "..1C1A1B1X1Z..6C6A6B6X6Z..7I7Q7X..8I8Q8X..5I5Q5X................"};
        case 110: return Family{System::Sbas, "..1C......................................5I5Q5X................"};
        case 111: return Family{System::Qzss, "..1C............6S6L6X......2S2L2X........5I5Q5X..........1S1L1X"};
        case 112: return Family{System::BeiDou, "..2I2Q2X......6I6Q6X......7I7Q7X..........5D5P5X7D........1D1P1X"};
        default: return std::nullopt;
    }
}

/// Instant of the message's time field, 30 bits.
Time instant(Bits& bits, System system, Time now) {
    if (system != System::Glonass) {
        const double second = static_cast<double>(bits.take(30)) * 1e-3;
        return nearest_in_week(second, now, system);
    }
    bits.skip(3);
    const auto of_day = static_cast<std::int64_t>(bits.take(27)) * 1'000'000;
    return nearest_in_moscow_day(of_day, now);
}

struct SatelliteData {
    double rough_ms = NAN, rough_rate = NAN;
    int information = 15;
};

/// Sizes of the signal fields of one type of message.
struct Layout {
    bool rates, fine;
    std::size_t range, phase, lock, strength;
    int range_scale, phase_scale;
};
Layout layout_of(int type) {
    const bool fine = type >= 6;
    return {type == 5 || type == 7, fine, fine ? 20U : 15U, fine ? 24U : 22U, fine ? 10U : 4U, fine ? 10U : 6U, fine ? -29 : -24,
            fine ? -31 : -29};
}

double field(Bits& bits, std::size_t size, int scale) { return std::ldexp(field_or_none(bits, size), scale); }

std::vector<SatelliteData> satellites(Bits& bits, std::size_t count, const Layout& layout) {
    std::vector<SatelliteData> all(count);
    for (auto& s : all) {
        const int ms = bits.integer(8);
        s.rough_ms = ms == 255 ? NAN : ms;
    }
    if (layout.rates) {
        for (auto& s : all) s.information = bits.integer(4);
    }
    for (auto& s : all) s.rough_ms += std::ldexp(static_cast<double>(bits.take(10)), -10);
    if (layout.rates) {
        for (auto& s : all) s.rough_rate = field(bits, 14, 0);
    }
    return all;
}

}  // namespace

bool is_msm(int number) { return family_of(number) && number % 10 >= 4 && number % 10 <= 7; }

Decoded rtcm3_msm(std::string_view payload, int number, Time now, gnss::GlonassChannels& channels, MeasuredEpoch& out) {
    const Family family = *family_of(number);
    const Layout layout = layout_of(number % 10);
    Bits bits(payload);
    bits.skip(24);
    out.time = instant(bits, family.system, now);
    out.more = bits.take(1) != 0;
    bits.skip(18);
    const std::uint64_t satellite_mask = bits.take(64), signal_mask = bits.take(32);
    std::vector<std::uint8_t> numbers;
    for (unsigned i = 0; i < 64; ++i) {
        // SBAS counts from PRN 120, QZSS from 193
        const unsigned first = family.system == System::Sbas ? 20 : 1;
        if ((satellite_mask >> (63 - i) & 1U) != 0) numbers.push_back(static_cast<std::uint8_t>(first + i));
    }
    std::vector<Signal> signals;
    for (unsigned i = 0; i < 32; ++i) {
        if ((signal_mask >> (31 - i) & 1U) != 0) signals.push_back({family.signals[2 * i], family.signals[2 * i + 1]});
    }
    const std::size_t cells_possible = numbers.size() * signals.size();
    if (cells_possible == 0 || cells_possible > 64) return Decoded::Damaged;
    struct Cell {
        std::size_t satellite, signal;
        double range = NAN, phase = NAN, rate = NAN, cn0 = NAN;
        bool half = false;
        int lock = 0;
    };
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < cells_possible; ++i) {
        if (bits.take(1) != 0) cells.push_back({i / signals.size(), i % signals.size()});
    }
    const std::vector<SatelliteData> rough = satellites(bits, numbers.size(), layout);
    for (Cell& c : cells) c.range = field(bits, layout.range, layout.range_scale);
    for (Cell& c : cells) c.phase = field(bits, layout.phase, layout.phase_scale);
    for (Cell& c : cells) c.lock = bits.integer(layout.lock);
    for (Cell& c : cells) c.half = bits.take(1) != 0;
    for (Cell& c : cells) c.cn0 = static_cast<double>(bits.take(layout.strength)) * (layout.fine ? 0.0625 : 1.0);
    if (layout.rates) {
        for (Cell& c : cells) c.rate = field(bits, 15, 0) * 1e-4;
    }
    if (!bits.ok()) return Decoded::Damaged;
    for (const Cell& c : cells) {
        const SatelliteData& s = rough[c.satellite];
        gnss::SignalObservation o;
        o.satellite = {family.system, numbers[c.satellite]};
        o.signal = signals[c.signal];
        if (o.signal.band == '.') continue;
        if (family.system == System::Glonass && layout.rates && s.information < 14)
            channels.of_slot[o.satellite.number] = static_cast<std::int8_t>(s.information - 7);
        const std::int8_t channel = family.system == System::Glonass ? channels.of_slot[o.satellite.number] : std::int8_t{0};
        o.pseudorange = (s.rough_ms + c.range) * metres_per_ms;
        if (channel != gnss::unknown_channel) {
            const double per_metre = gnss::frequency_of(family.system, o.signal.band, channel) / gnss::speed_of_light;
            o.phase = (s.rough_ms + c.phase) * metres_per_ms * per_metre;
            o.doppler = -(s.rough_rate + c.rate) * per_metre;
        }
        if (c.cn0 > 0.0) o.cn0 = c.cn0;
        o.loss_of_lock = c.half ? 2 : 0;
        if (!std::isfinite(o.pseudorange) && !std::isfinite(o.phase)) continue;
        out.observations.push_back(o);
        out.locks.push_back(c.lock);
    }
    return Decoded::Used;
}

}  // namespace schuler::io::detail
