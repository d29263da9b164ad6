// BeiDou subframes: D1 of the medium and inclined orbits, D2 of the geostationary ones. Same numbers in different order.
#include "schuler/io/detail/broadcast_scales.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/receiver/detail/navigation_frames.h"

#include <algorithm>

namespace schuler::io::detail {
namespace {

// Information bits of a subframe: preamble, reserved, number of the subframe, second of week, and (D2) the page
constexpr std::size_t number_at = 15, second_at = 18, page_at = 38, d1_data = 38, d2_data = 42;
constexpr int week_wrap = 8192;

int second_of(const std::string& frame) { return static_cast<int>(Bits(frame).at(second_at, 20)); }

/// True if parts were transmitted consecutively, `step` seconds apart.
bool in_one_go(std::span<const std::string> parts, int step) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].empty() || second_of(parts[i]) != second_of(parts[0]) + step * static_cast<int>(i)) return false;
    }
    return true;
}

/// Common start of both messages: health to the group delays. Returns the seconds of week of the clock reference.
double clock_head(Bits& b, gnss::KeplerEphemeris& k, int& week) {
    k.health = b.integer(1);
    k.iodc = b.integer(5);
    k.accuracy = gps_accuracy(b.integer(4));
    week = b.integer(13);
    const double toc = 8.0 * static_cast<double>(b.take(17));
    k.group_delay = {1e-10 * static_cast<double>(b.take_signed(10)), 1e-10 * static_cast<double>(b.take_signed(10))};
    return toc;
}

}  // namespace

bool FrameCollector::beidou_subframe(gnss::SatelliteId satellite, const std::array<std::uint32_t, 10>& words, Time now) {
    BitWriter data;
    data.put(words[0] >> 4, 26);
    for (std::size_t i = 1; i < words.size(); ++i) data.put(words[i] >> 8, 22);
    const Bits bits(data.bytes());
    constexpr unsigned preamble = 0x712;
    const std::size_t id = bits.at(number_at, 3), page = bits.at(page_at, 4);
    if (bits.at(0, 11) != preamble || id < 1 || id > 5) return false;
    const bool d2 = gnss::is_geostationary_beidou(satellite);
    // D2 transmits ephemerides in the ten pages of subframe 1, D1 in subframes 1 to 3
    if (d2 ? id != 1 || page < 1 || page > 10 : id > 3) return true;
    BeiDouFrames& frames = beidou_[satellite];
    frames.parts[(d2 ? page : id) - 1] = data.bytes();
    constexpr int between_subframes = 6, between_pages = 3;
    if (d2 && in_one_go(frames.parts, between_pages)) beidou_d2(satellite, frames, now);
    if (!d2 && in_one_go(std::span(frames.parts).first(3), between_subframes)) beidou_d1(satellite, frames, now);
    return true;
}

void FrameCollector::beidou_d1(gnss::SatelliteId satellite, const BeiDouFrames& frames, Time now) {
    gnss::KeplerEphemeris k;
    k.satellite = satellite;
    k.message = gnss::NavMessage::D1;
    Bits one(frames.parts[0]), two(frames.parts[1]), three(frames.parts[2]);
    for (Bits* b : {&one, &two, &three}) b->seek(d1_data);
    int week = 0;
    const double toc = clock_head(one, k, week);
    navigation_.klobuchar[static_cast<std::size_t>(satellite.system)] = klobuchar_of(one);
    k.af2 = scaled(one, 11, -66), k.af0 = scaled(one, 24, -33), k.af1 = scaled(one, 22, -50);
    k.iode = one.integer(5);
    k.delta_n = angle(two, 16, -43), k.cuc = scaled(two, 18, -31), k.m0 = angle(two, 32, -31);
    k.e = scaled_unsigned(two, 32, -33), k.cus = scaled(two, 18, -31), k.crc = scaled(two, 18, -6);
    k.crs = scaled(two, 18, -6), k.sqrt_a = scaled_unsigned(two, 32, -19);
    const std::uint64_t toe_high = two.take(2), toe_low = three.take(15);
    k.i0 = angle(three, 32, -31), k.cic = scaled(three, 18, -31), k.omega_dot = angle(three, 24, -43);
    k.cis = scaled(three, 18, -31), k.idot = angle(three, 14, -43);
    k.omega0 = angle(three, 32, -31), k.omega = angle(three, 32, -31);
    k.toc = from_week_count(satellite.system, week, week_wrap, toc, now);
    set_times(k, 8.0 * static_cast<double>(toe_high << 15 | toe_low), second_of(frames.parts[0]));
    add(k);
}

void FrameCollector::beidou_d2(gnss::SatelliteId satellite, const BeiDouFrames& frames, Time now) {
    gnss::KeplerEphemeris k;
    k.satellite = satellite;
    k.message = gnss::NavMessage::D2;
    Bits one(frames.parts[0]);
    one.seek(d2_data);
    int week = 0;
    const double toc = clock_head(one, k, week);
    // pages 3 to 10 divide one sequence of numbers at page boundaries: position of each page's piece
    struct Piece {
        std::size_t first, last;
    };
    constexpr std::array<Piece, 8> pieces = {
        {{80, 108}, {42, 106}, {42, 106}, {42, 106}, {42, 106}, {42, 108}, {42, 106}, {42, 61}}};
    BitWriter row;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        row.put(Bits(frames.parts[i + 2]), pieces[i].first, pieces[i].last - pieces[i].first);
    Bits b(row.bytes());
    k.af0 = scaled(b, 24, -33), k.af1 = scaled(b, 22, -50), k.af2 = scaled(b, 11, -66);
    k.iode = b.integer(5);
    k.delta_n = angle(b, 16, -43), k.cuc = scaled(b, 18, -31), k.m0 = angle(b, 32, -31), k.cus = scaled(b, 18, -31);
    k.e = scaled_unsigned(b, 32, -33), k.sqrt_a = scaled_unsigned(b, 32, -19);
    k.cic = scaled(b, 18, -31), k.cis = scaled(b, 18, -31);
    const double toe = 8.0 * static_cast<double>(b.take(17));
    k.i0 = angle(b, 32, -31), k.crc = scaled(b, 18, -6), k.crs = scaled(b, 18, -6), k.omega_dot = angle(b, 24, -43);
    k.omega0 = angle(b, 32, -31), k.omega = angle(b, 32, -31), k.idot = angle(b, 14, -43);
    k.toc = from_week_count(satellite.system, week, week_wrap, toc, now);
    set_times(k, toe, second_of(frames.parts[0]));
    add(k);
}

}  // namespace schuler::io::detail
