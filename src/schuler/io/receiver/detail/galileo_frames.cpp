// Galileo I/NAV and F/NAV pages.
#include "schuler/io/detail/broadcast_scales.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/receiver/detail/navigation_frames.h"

#include <algorithm>

namespace schuler::io::detail {
namespace {

void galileo_clock(Bits& b, gnss::KeplerEphemeris& k) {
    k.af0 = scaled(b, 31, -34), k.af1 = scaled(b, 21, -46), k.af2 = scaled(b, 6, -59);
}
void galileo_harmonics(Bits& b, gnss::KeplerEphemeris& k) {
    k.cuc = scaled(b, 16, -29), k.cus = scaled(b, 16, -29), k.crc = scaled(b, 16, -5), k.crs = scaled(b, 16, -5);
}
gnss::GalileoIonosphere galileo_ionosphere_of(Bits& b) {
    gnss::GalileoIonosphere out;
    out.a = {scaled_unsigned(b, 11, -2), scaled(b, 11, -8), scaled(b, 14, -15)};
    b.skip(5);  // storms by region
    return out;
}

}  // namespace

bool FrameCollector::galileo_page(gnss::SatelliteId satellite, std::span<const std::uint32_t, 8> words, Time now) {
    BitWriter even, odd;
    for (const std::uint32_t word : words.first<4>()) even.put(word, 32);
    for (const std::uint32_t word : words.last<4>()) odd.put(word, 32);
    const Bits e(even.bytes()), o(odd.bytes());
    // nominal pages, even part first; the check covers 114 bits of the first and 82 of the second
    if (e.at(0, 1) != 0 || o.at(0, 1) != 1) return false;
    if (e.at(1, 1) != 0 || o.at(1, 1) != 0) return true;  // alert pages contain no ephemeris
    BitWriter checked, data;
    checked.put(0, 4);  // to whole bytes
    checked.put(e, 0, 114);
    checked.put(o, 0, 82);
    if (crc24q(checked.bytes()) != o.at(82, 24)) return false;
    data.put(e, 2, 112);
    data.put(o, 2, 16);
    const auto type = Bits(data.bytes()).at(0, 6);
    if (type < 1 || type > 5) return true;
    GalileoWords& collected = galileo_[satellite];
    collected.words[type - 1] = data.bytes();
    if (std::ranges::none_of(collected.words, &std::string::empty)) galileo_ephemeris(satellite, collected, now);
    return true;
}

void FrameCollector::galileo_ephemeris(gnss::SatelliteId satellite, const GalileoWords& collected, Time now) {
    gnss::KeplerEphemeris k;
    k.satellite = satellite;
    k.message = gnss::NavMessage::Inav;
    Bits one(collected.words[0]), two(collected.words[1]), three(collected.words[2]), four(collected.words[3]),
        five(collected.words[4]);
    constexpr std::size_t type_bits = 6, issue_bits = 10;
    k.iode = static_cast<int>(one.at(type_bits, issue_bits));
    for (Bits* b : {&one, &two, &three, &four}) {
        b->skip(type_bits);
        if (b->integer(issue_bits) != k.iode) return;
    }
    const double toe = 60.0 * static_cast<double>(one.take(14));
    k.m0 = angle(one, 32, -31), k.e = scaled_unsigned(one, 32, -33), k.sqrt_a = scaled_unsigned(one, 32, -19);
    k.omega0 = angle(two, 32, -31), k.i0 = angle(two, 32, -31), k.omega = angle(two, 32, -31), k.idot = angle(two, 14, -43);
    k.omega_dot = angle(three, 24, -43), k.delta_n = angle(three, 16, -43);
    galileo_harmonics(three, k);
    k.accuracy = galileo_accuracy(three.integer(8));
    if (four.integer(6) != satellite.number) return;
    k.cic = scaled(four, 16, -29), k.cis = scaled(four, 16, -29);
    const double toc = 60.0 * static_cast<double>(four.take(14));
    galileo_clock(four, k);
    five.skip(6);
    navigation_.galileo_ionosphere = galileo_ionosphere_of(five);
    k.group_delay = {scaled(five, 10, -32), scaled(five, 10, -32)};
    const int health_e5b = five.integer(2), health_e1 = five.integer(2), valid_e5b = five.integer(1), valid_e1 = five.integer(1);
    k.health = galileo_health(valid_e1, health_e1, valid_e5b, health_e5b);
    const int week = five.integer(12);
    const double sent = static_cast<double>(five.take(20));
    const Time transmitted = from_week_count(satellite.system, week, 4096, sent, now);
    k.toc = nearest_in_week(toc, transmitted);
    set_times(k, toe, sent);
    add(k);
}

bool FrameCollector::galileo_freely_accessible_page(gnss::SatelliteId satellite, std::span<const std::uint32_t, 8> words,
                                                    Time now) {
    BitWriter all, checked;
    for (const std::uint32_t word : words) all.put(word, 32);
    const Bits bits(all.bytes());
    constexpr std::size_t fnav_checked = 214;
    checked.put(0, 2);  // to whole bytes
    checked.put(bits, 0, fnav_checked);
    if (crc24q(checked.bytes()) != bits.at(fnav_checked, 24)) return false;
    const auto type = bits.at(0, 6);
    if (type < 1 || type > 4) return true;
    FnavPages& collected = fnav_[satellite];
    collected.pages[type - 1] = all.bytes();
    if (std::ranges::none_of(collected.pages, &std::string::empty)) fnav_ephemeris(satellite, collected, now);
    return true;
}

void FrameCollector::fnav_ephemeris(gnss::SatelliteId satellite, const FnavPages& collected, Time now) {
    gnss::KeplerEphemeris k;
    k.satellite = satellite;
    k.message = gnss::NavMessage::Fnav;
    Bits one(collected.pages[0]), two(collected.pages[1]), three(collected.pages[2]), four(collected.pages[3]);
    constexpr std::size_t type_bits = 6, issue_bits = 10;
    for (Bits* b : {&one, &two, &three, &four}) b->skip(type_bits);
    if (one.integer(6) != satellite.number) return;
    k.iode = one.integer(issue_bits);
    for (Bits* b : {&two, &three, &four})
        if (b->integer(issue_bits) != k.iode) return;
    const double toc = 60.0 * static_cast<double>(one.take(14));
    galileo_clock(one, k);
    k.accuracy = galileo_accuracy(one.integer(8));
    navigation_.galileo_ionosphere = galileo_ionosphere_of(one);
    k.group_delay[0] = scaled(one, 10, -32);
    const int health = one.integer(2), week = one.integer(12);
    const double sent = static_cast<double>(one.take(20));
    k.health = galileo_health_of_e5a(one.integer(1), health);
    k.m0 = angle(two, 32, -31), k.omega_dot = angle(two, 24, -43), k.e = scaled_unsigned(two, 32, -33);
    k.sqrt_a = scaled_unsigned(two, 32, -19), k.omega0 = angle(two, 32, -31), k.idot = angle(two, 14, -43);
    k.i0 = angle(three, 32, -31), k.omega = angle(three, 32, -31), k.delta_n = angle(three, 16, -43);
    galileo_harmonics(three, k);
    const double toe = 60.0 * static_cast<double>(three.take(14));
    k.cic = scaled(four, 16, -29), k.cis = scaled(four, 16, -29);
    const Time transmitted = from_week_count(satellite.system, week, 4096, sent, now);
    k.toc = nearest_in_week(toc, transmitted);
    set_times(k, toe, sent);
    add(k);
}

}  // namespace schuler::io::detail
