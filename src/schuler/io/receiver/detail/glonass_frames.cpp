// GLONASS strings: the first four of a frame are the transmitting satellite's own ephemeris.
#include "schuler/io/detail/broadcast_scales.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/receiver/detail/navigation_frames.h"

#include <algorithm>
#include <bit>

namespace schuler::io::detail {
namespace {

constexpr std::size_t string_bits = 85;

/// Hamming check of a string [GLONASSICD:4.7]: bits 9 to 85 occupy the places that are not powers of two, the seven check bits (1
/// to 7) those that are, and the eighth makes the number of ones even. The string starts with bit 85.
bool fits_check_bits(const Bits& string) {
    const auto bit = [&](std::size_t number) { return static_cast<unsigned>(string.at(string_bits - number, 1)); };
    unsigned places = 0, ones = bit(8), check = 0, place = 2;
    for (unsigned i = 0; i < 7; ++i) {
        check |= bit(i + 1) << i;
        ones += bit(i + 1);
    }
    for (std::size_t number = 9; number <= string_bits; ++number) {
        do ++place;
        while (std::has_single_bit(place));
        if (bit(number) == 0) continue;
        places ^= place;
        ++ones;
    }
    return places == check && ones % 2 == 0;
}

double metric(Bits& b, std::size_t count, int exponent) {
    constexpr double km = 1000.0;
    return km * std::ldexp(static_cast<double>(b.take_sign_magnitude(count)), exponent);
}

}  // namespace

void FrameCollector::glonass_ephemeris(gnss::SatelliteId satellite, const GlonassStrings& s, int channel, Time now) {
    gnss::GlonassEphemeris g;
    g.satellite = satellite;
    g.channel = channel;
    for (std::size_t i = 0; i < 3; ++i) {
        Bits b(s.strings[i]);
        const auto axis = static_cast<Eigen::Index>(i);
        b.seek(21);
        g.velocity[axis] = metric(b, 24, -20), g.acceleration[axis] = metric(b, 5, -30), g.position[axis] = metric(b, 27, -11);
    }
    Bits two(s.strings[1]), three(s.strings[2]), four(s.strings[3]);
    two.seek(5);
    g.health = two.integer(1);
    two.skip(2 + 1);
    constexpr std::int64_t quarter_hour = 900'000'000'000;
    const std::int64_t tb = static_cast<std::int64_t>(two.take(7)) * quarter_hour;
    three.seek(6);
    g.clock_rate = std::ldexp(static_cast<double>(three.take_sign_magnitude(11)), -40);
    three.skip(1 + 2);
    g.health |= three.integer(1);
    four.seek(5);
    g.clock = -std::ldexp(static_cast<double>(four.take_sign_magnitude(22)), -30);
    g.l2_delay = std::ldexp(static_cast<double>(four.take_sign_magnitude(5)), -30);
    g.age_days = four.integer(5);
    constexpr std::size_t number_at = 70;
    four.seek(number_at);
    if (four.integer(5) != satellite.number) return;
    g.toe = nearest_in_moscow_day(tb, now);
    g.transmission = now;
    if (is_sound(g)) add_new(navigation_.glonass, g);
}

bool FrameCollector::glonass_string(gnss::SatelliteId satellite, const std::array<std::uint32_t, 4>& words, int channel,
                                    Time now) {
    BitWriter data;
    for (std::size_t i = 0; i < 3; ++i) data.put(words[i], 32);
    const Bits bits(data.bytes());
    if (!fits_check_bits(bits)) return false;
    const std::size_t number = bits.at(1, 4);
    GlonassStrings& collected = glonass_[satellite];
    // strings of another frame may have another reference time
    if (collected.frame != words[3]) collected = {{}, words[3]};
    if (number < 1 || number > 4) return true;
    collected.strings[number - 1] = data.bytes();
    if (std::ranges::none_of(collected.strings, &std::string::empty)) glonass_ephemeris(satellite, collected, channel, now);
    return true;
}

}  // namespace schuler::io::detail
