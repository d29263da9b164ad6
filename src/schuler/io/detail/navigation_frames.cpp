#include "schuler/io/detail/navigation_frames.h"

#include "schuler/io/detail/broadcast_scales.h"
#include "schuler/io/detail/ephemeris_checks.h"

#include <algorithm>

namespace schuler::io::detail {
namespace {

/// Bytes of words whose lowest `width` bits count.
std::string packed(std::span<const std::uint32_t> words, std::size_t width) {
    std::string out((words.size() * width + 7) / 8, '\0');
    std::size_t bit = 0;
    for (const std::uint32_t word : words) {
        for (std::size_t i = 0; i < width; ++i, ++bit) {
            if ((word >> (width - 1 - i) & 1U) != 0) out[bit / 8] = static_cast<char>(out[bit / 8] | (0x80 >> bit % 8));
        }
    }
    return out;
}

constexpr std::size_t data_bits = 24;

}  // namespace

void FrameCollector::add(const gnss::KeplerEphemeris& k) {
    const auto same = [&](const gnss::KeplerEphemeris& other) {
        return other.satellite == k.satellite && other.toe == k.toe && other.iode == k.iode && other.message == k.message;
    };
    if (is_sound(k) && std::none_of(navigation_.kepler.rbegin(), navigation_.kepler.rend(), same))
        navigation_.kepler.push_back(k);
}

bool FrameCollector::gps_subframe(gnss::SatelliteId satellite, const std::array<std::uint32_t, 10>& words, Time now) {
    const std::string bytes = packed(words, data_bits);
    const Bits bits(bytes);
    constexpr unsigned preamble = 0x8B;
    const auto id = bits.at(43, 3);
    if (bits.at(0, 8) != preamble || id < 1 || id > 5) return false;
    if (id == 4) gps_ionosphere(satellite, bytes);
    if (id > 3) return true;
    GpsFrames& frames = gps_[satellite];
    frames.subframes[id - 1] = bytes;
    if (std::ranges::none_of(frames.subframes, &std::string::empty)) gps_ephemeris(satellite, frames, now);
    return true;
}

void FrameCollector::gps_ephemeris(gnss::SatelliteId satellite, const GpsFrames& frames, Time now) {
    gnss::KeplerEphemeris k;
    k.satellite = satellite;
    Bits one(frames.subframes[0]), two(frames.subframes[1]), three(frames.subframes[2]);
    one.seek(24);
    const double sent = 6.0 * (static_cast<double>(one.take(17)) - 1.0);
    one.seek(48);
    const int week = one.integer(10);
    one.skip(2);
    k.accuracy = gps_accuracy(one.integer(4));
    k.health = one.integer(6);
    const int iodc_high = one.integer(2);
    one.seek(160);
    k.group_delay[0] = scaled(one, 8, -31);
    k.iodc = iodc_high << 8 | one.integer(8);
    const double toc = scaled_unsigned(one, 16, 4);
    k.af2 = scaled(one, 8, -55), k.af1 = scaled(one, 16, -43), k.af0 = scaled(one, 22, -31);
    two.seek(48);
    k.iode = two.integer(8);
    k.crs = scaled(two, 16, -5), k.delta_n = angle(two, 16, -43), k.m0 = angle(two, 32, -31);
    k.cuc = scaled(two, 16, -29), k.e = scaled_unsigned(two, 32, -33), k.cus = scaled(two, 16, -29);
    k.sqrt_a = scaled_unsigned(two, 32, -19);
    const double toe = scaled_unsigned(two, 16, 4);
    k.fit_interval = two.take(1) != 0 ? 6.0 * 3600.0 : 4.0 * 3600.0;
    three.seek(48);
    k.cic = scaled(three, 16, -29), k.omega0 = angle(three, 32, -31), k.cis = scaled(three, 16, -29),
    k.i0 = angle(three, 32, -31);
    k.crc = scaled(three, 16, -5), k.omega = angle(three, 32, -31), k.omega_dot = angle(three, 24, -43);
    const int iode = three.integer(8);
    k.idot = angle(three, 14, -43);
    // all three subframes of one upload
    if (iode != k.iode || (k.iodc & 0xFF) != k.iode) return;
    const Time transmitted = from_week_count(week, 1024, 0, sent, now);
    k.toc = nearest_in_week(toc, transmitted);
    set_times(k, toe, sent);
    add(k);
}

void FrameCollector::gps_ionosphere(gnss::SatelliteId satellite, const std::string& subframe) {
    Bits bits(subframe);
    bits.seek(50);
    constexpr int page_18 = 56;
    if (bits.integer(6) != page_18) return;
    gnss::KlobucharCoefficients c;
    constexpr std::array<int, 4> alpha = {-30, -27, -24, -24}, beta = {11, 14, 16, 16};
    for (std::size_t i = 0; i < 4; ++i) c.alpha[i] = scaled(bits, 8, alpha[i]);
    for (std::size_t i = 0; i < 4; ++i) c.beta[i] = scaled(bits, 8, beta[i]);
    navigation_.klobuchar[static_cast<std::size_t>(satellite.system)] = c;
    bits.seek(192);
    navigation_.leap_seconds = static_cast<int>(bits.take_signed(8));
}

bool FrameCollector::galileo_page(gnss::SatelliteId satellite, std::span<const std::uint32_t, 8> words, Time now) {
    const std::string even = packed(words.first<4>(), 32), odd = packed(words.last<4>(), 32);
    const Bits e(even), o(odd);
    // nominal pages, even part first; the check covers 114 bits of the one and 82 of the other
    if (e.at(0, 1) != 0 || o.at(0, 1) != 1) return false;
    if (e.at(1, 1) != 0 || o.at(1, 1) != 0) return true;  // alert pages carry no ephemeris
    std::string checked(25, '\0');
    const auto put = [&](std::size_t bit) { checked[bit / 8] = static_cast<char>(checked[bit / 8] | (0x80 >> bit % 8)); };
    for (std::size_t i = 0; i < 114; ++i) {
        if (e.at(i, 1) != 0) put(4 + i);
    }
    for (std::size_t i = 0; i < 82; ++i) {
        if (o.at(i, 1) != 0) put(4 + 114 + i);
    }
    if (crc24q(checked) != o.at(82, 24)) return false;
    std::string data(16, '\0');
    for (std::size_t i = 0; i < 128; ++i) {
        const bool bit = i < 112 ? e.at(2 + i, 1) != 0 : o.at(2 + i - 112, 1) != 0;
        if (bit) data[i / 8] = static_cast<char>(data[i / 8] | (0x80 >> i % 8));
    }
    const auto type = Bits(data).at(0, 6);
    if (type < 1 || type > 5) return true;
    GalileoWords& collected = galileo_[satellite];
    collected.words[type - 1] = data;
    if (std::ranges::none_of(collected.words, &std::string::empty)) galileo_ephemeris(satellite, collected, now);
    return true;
}

void FrameCollector::galileo_ephemeris(gnss::SatelliteId satellite, const GalileoWords& collected, Time now) {
    gnss::KeplerEphemeris k;
    k.satellite = satellite;
    k.message = gnss::NavMessage::Inav;
    Bits one(collected.words[0]), two(collected.words[1]), three(collected.words[2]), four(collected.words[3]),
        five(collected.words[4]);
    std::array<int, 4> issue{};
    for (Bits* b : {&one, &two, &three, &four}) {
        b->skip(6);
        issue[static_cast<std::size_t>(b == &one ? 0 : b == &two ? 1 : b == &three ? 2 : 3)] = b->integer(10);
    }
    if (issue[0] != issue[1] || issue[0] != issue[2] || issue[0] != issue[3]) return;
    k.iode = issue[0];
    const double toe = 60.0 * static_cast<double>(one.take(14));
    k.m0 = angle(one, 32, -31), k.e = scaled_unsigned(one, 32, -33), k.sqrt_a = scaled_unsigned(one, 32, -19);
    k.omega0 = angle(two, 32, -31), k.i0 = angle(two, 32, -31), k.omega = angle(two, 32, -31), k.idot = angle(two, 14, -43);
    k.omega_dot = angle(three, 24, -43), k.delta_n = angle(three, 16, -43);
    k.cuc = scaled(three, 16, -29), k.cus = scaled(three, 16, -29), k.crc = scaled(three, 16, -5), k.crs = scaled(three, 16, -5);
    k.accuracy = galileo_accuracy(three.integer(8));
    if (four.integer(6) != satellite.number) return;
    k.cic = scaled(four, 16, -29), k.cis = scaled(four, 16, -29);
    const double toc = 60.0 * static_cast<double>(four.take(14));
    k.af0 = scaled(four, 31, -34), k.af1 = scaled(four, 21, -46), k.af2 = scaled(four, 6, -59);
    five.skip(6);
    gnss::GalileoIonosphere ionosphere;
    ionosphere.a = {scaled_unsigned(five, 11, -2), scaled(five, 11, -8), scaled(five, 14, -15)};
    navigation_.galileo_ionosphere = ionosphere;
    five.skip(5);
    k.group_delay = {scaled(five, 10, -32), scaled(five, 10, -32)};
    const int health_e5b = five.integer(2), health_e1 = five.integer(2), valid_e5b = five.integer(1), valid_e1 = five.integer(1);
    // the bits of RINEX: E1-B validity and health, then those of E5a (not sent here), then E5b
    k.health = valid_e1 | health_e1 << 1 | valid_e5b << 6 | health_e5b << 7;
    const int week = five.integer(12);
    const double sent = static_cast<double>(five.take(20));
    constexpr int week_of_galileo = 1024;
    const Time transmitted = from_week_count(week, 4096, week_of_galileo, sent, now);
    k.toc = nearest_in_week(toc, transmitted);
    set_times(k, toe, sent);
    add(k);
}

}  // namespace schuler::io::detail
