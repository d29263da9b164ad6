// GPS CNAV messages of L2C and L5.
#include "schuler/io/detail/broadcast_scales.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/receiver/detail/navigation_frames.h"

#include <algorithm>
#include <cmath>

namespace schuler::io::detail {
namespace {

constexpr std::size_t cnav_checked = 276, cnav_head = 38;  // bits of a message; preamble, satellite, type, time and alert

/// Accuracy index of CNAV, two's complement [ISGPS200:30.3.3.1.1.4], m.
double cnav_accuracy(int index) {
    if (index == 1) return 2.8;
    if (index == 3) return 5.7;
    if (index == 5) return 11.3;
    if (index < -15 || index > 14) return 8192.0;  // no prediction
    return std::exp2(index <= 6 ? 1.0 + 0.5 * index : index - 2.0);
}

/// A correction of 13 bits, s; its most negative value means that it is not known.
double correction(Bits& bits) {
    const std::int64_t raw = bits.take_signed(13);
    return raw == -4096 ? 0.0 : std::ldexp(static_cast<double>(raw), -35);
}

}  // namespace

bool FrameCollector::gps_message(gnss::SatelliteId satellite, std::span<const std::uint32_t, 10> words, Time now) {
    BitWriter all, checked;
    for (const std::uint32_t word : words) all.put(word, 32);
    const Bits bits(all.bytes());
    constexpr unsigned preamble = 0x8B;
    checked.put(0, 4);  // to whole bytes
    checked.put(bits, 0, cnav_checked);
    if (bits.at(0, 8) != preamble || crc24q(checked.bytes()) != bits.at(cnav_checked, 24)) return false;
    if (bits.at(8, 6) != satellite.number) return true;
    const auto type = bits.at(14, 6);
    if (type != 10 && type != 11 && (type < 30 || type > 37)) return true;
    CnavMessages& messages = cnav_[satellite];
    messages.parts[type == 10 ? 0 : type == 11 ? 1 : 2] = all.bytes();
    if (type == 30) messages.delays = all.bytes();
    if (std::ranges::none_of(messages.parts, &std::string::empty) && !messages.delays.empty())
        cnav_ephemeris(satellite, messages, now);
    return true;
}

void FrameCollector::cnav_ephemeris(gnss::SatelliteId satellite, const CnavMessages& messages, Time now) {
    gnss::KeplerEphemeris k;
    k.satellite = satellite;
    k.message = gnss::NavMessage::Cnav;
    Bits ten(messages.parts[0]), eleven(messages.parts[1]), clock(messages.parts[2]), delays(messages.delays);
    const double sent = 6.0 * static_cast<double>(ten.at(20, 17)) - 12.0;
    for (Bits* b : {&ten, &eleven, &clock, &delays}) b->seek(cnav_head);
    const int week = ten.integer(13);
    constexpr int l1_and_l2 = 6;  // L5 is marked as unusable until its system is complete
    k.health = ten.integer(3) & l1_and_l2;
    const auto predicted = ten.take(11);
    const double of_orbit = cnav_accuracy(static_cast<int>(ten.take_signed(5)));
    const int toe = ten.integer(11);
    constexpr double reference = 26'559'710.0;  // m, of the semi-major axis
    k.sqrt_a = std::sqrt(reference + scaled(ten, 26, -9));
    k.a_rate = scaled(ten, 25, -21);
    k.delta_n = angle(ten, 17, -44), k.delta_n_rate = angle(ten, 23, -57);
    k.m0 = angle(ten, 33, -32), k.e = scaled_unsigned(ten, 33, -34), k.omega = angle(ten, 33, -32);
    if (eleven.integer(11) != toe) return;
    k.omega0 = angle(eleven, 33, -32), k.i0 = angle(eleven, 33, -32);
    constexpr double node_rate = -2.6e-9;  // semicircles/s, from which the message gives the difference
    k.omega_dot = std::numbers::pi * node_rate + angle(eleven, 17, -44), k.idot = angle(eleven, 15, -44);
    k.cis = scaled(eleven, 16, -30), k.cic = scaled(eleven, 16, -30);
    k.crs = scaled(eleven, 24, -8), k.crc = scaled(eleven, 24, -8);
    k.cus = scaled(eleven, 21, -30), k.cuc = scaled(eleven, 21, -30);
    if (clock.take(11) != predicted) return;
    k.accuracy = std::hypot(of_orbit, cnav_accuracy(static_cast<int>(clock.take_signed(5))));
    clock.skip(6);  // growth of the clock's accuracy
    const double toc = 300.0 * static_cast<double>(clock.take(11));
    k.af0 = scaled(clock, 26, -35), k.af1 = scaled(clock, 20, -48), k.af2 = scaled(clock, 10, -60);
    constexpr std::size_t before_delays = 127;
    delays.seek(before_delays);
    const double common = correction(delays), l1 = correction(delays), l2 = correction(delays);
    delays.skip(13);  // L5 I
    k.group_delay = {common - l1, common - l2, common - correction(delays)};
    k.iode = toe;
    constexpr double hour = 3600.0;
    k.fit_interval = 3.0 * hour;
    const Time transmitted = from_week_count(satellite.system, week, 8192, sent, now);
    k.toc = nearest_in_week(toc, transmitted);
    set_times(k, 300.0 * toe, sent);
    add(k);
}

}  // namespace schuler::io::detail
