#include "schuler/io/receiver/detail/navigation_frames.h"

#include "schuler/io/detail/broadcast_scales.h"
#include "schuler/io/detail/ephemeris_checks.h"

#include <algorithm>

namespace schuler::io::detail {

void FrameCollector::add(const gnss::KeplerEphemeris& k) {
    if (is_sound(k)) add_new(navigation_.kepler, k);
}

bool FrameCollector::gps_subframe(gnss::SatelliteId satellite, const std::array<std::uint32_t, 10>& words, Time now) {
    BitWriter data;
    for (const std::uint32_t word : words) data.put(word, 24);
    const std::string& bytes = data.bytes();
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
    clock_of_gps(one, k);
    two.seek(48);
    k.iode = two.integer(8);
    orbit_in_plane(two, k);
    const double toe = scaled_unsigned(two, 16, 4);
    k.fit_interval = two.take(1) != 0 ? 6.0 * 3600.0 : 4.0 * 3600.0;
    three.seek(48);
    orbit_plane(three, k);
    const int iode = three.integer(8);
    k.idot = angle(three, 14, -43);
    // all three subframes must be of one upload
    if (iode != k.iode || (k.iodc & 0xFF) != k.iode) return;
    const Time transmitted = from_week_count(satellite.system, week, 1024, sent, now);
    k.toc = nearest_in_week(toc, transmitted);
    set_times(k, toe, sent);
    add(k);
}

void FrameCollector::gps_ionosphere(gnss::SatelliteId satellite, const std::string& subframe) {
    Bits bits(subframe);
    bits.seek(50);
    constexpr int page_18 = 56;
    if (bits.integer(6) != page_18) return;
    navigation_.klobuchar[static_cast<std::size_t>(satellite.system)] = klobuchar_of(bits);
    bits.seek(192);
    navigation_.leap_seconds = static_cast<int>(bits.take_signed(8));
}

}  // namespace schuler::io::detail
