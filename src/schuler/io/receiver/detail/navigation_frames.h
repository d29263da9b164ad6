// Ephemerides assembled from transmitted frames, subframe by subframe. Private to the readers.
#pragma once

#include "schuler/gnss/ephemeris.h"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace schuler::io::detail {

/// Collects frames (GPS and QZSS LNAV, GPS CNAV, Galileo I/NAV and F/NAV, BeiDou D1 and D2, GLONASS strings) until an ephemeris is complete and
/// consistent; adds it if new. `now` is the receiver's time, within half the range of the broadcast week counters.
class FrameCollector {
public:
    explicit FrameCollector(gnss::Navigation& navigation) : navigation_(navigation) {}

    /// Ten words of 24 data bits, parity removed [ISGPS200:20.3.3]. False if the frame is invalid.
    bool gps_subframe(gnss::SatelliteId satellite, const std::array<std::uint32_t, 10>& words, Time now);
    /// Even and odd page parts of 120 bits each, left-aligned in four words of 32 bits [GalileoICD:4.3]. False if the check fails.
    bool galileo_page(gnss::SatelliteId satellite, std::span<const std::uint32_t, 8> words, Time now);
    /// A message of 300 bits, left-aligned in ten words of 32 bits [ISGPS200:30.3]. False if its check fails.
    bool gps_message(gnss::SatelliteId satellite, std::span<const std::uint32_t, 10> words, Time now);
    /// A page of 238 bits, left-aligned in eight words of 32 bits [GalileoICD:4.2]. False if the check fails.
    bool galileo_freely_accessible_page(gnss::SatelliteId satellite, std::span<const std::uint32_t, 8> words, Time now);
    /// Ten words of 30 bits, including parity [BeiDouICD:5.2, 5.3]. False if the frame is invalid.
    bool beidou_subframe(gnss::SatelliteId satellite, const std::array<std::uint32_t, 10>& words, Time now);
    /// A string of 85 bits, left-aligned in three words of 32 bits; a fourth has the superframe and frame numbers
    /// [GLONASSICD:4.3]. False if its check bits do not match. `channel` is the frequency number.
    bool glonass_string(gnss::SatelliteId satellite, const std::array<std::uint32_t, 4>& words, int channel, Time now);

private:
    struct GpsFrames {
        std::array<std::string, 3> subframes;
    };
    struct GalileoWords {
        std::array<std::string, 5> words;
    };
    /// Messages 10 and 11, and one of 30 to 37.
    struct CnavMessages {
        std::array<std::string, 3> parts;
        std::string delays;  ///< message 30
    };
    struct FnavPages {
        std::array<std::string, 4> pages;
    };
    /// D1: subframes 1 to 3. D2: the ten pages of subframe 1.
    struct BeiDouFrames {
        std::array<std::string, 10> parts;
    };
    struct GlonassStrings {
        std::array<std::string, 4> strings;
        std::uint32_t frame = 0;
    };
    void gps_ephemeris(gnss::SatelliteId satellite, const GpsFrames& frames, Time now);
    void gps_ionosphere(gnss::SatelliteId satellite, const std::string& subframe);
    void cnav_ephemeris(gnss::SatelliteId satellite, const CnavMessages& messages, Time now);
    void fnav_ephemeris(gnss::SatelliteId satellite, const FnavPages& pages, Time now);
    void galileo_ephemeris(gnss::SatelliteId satellite, const GalileoWords& words, Time now);
    void beidou_d1(gnss::SatelliteId satellite, const BeiDouFrames& frames, Time now);
    void beidou_d2(gnss::SatelliteId satellite, const BeiDouFrames& frames, Time now);
    void glonass_ephemeris(gnss::SatelliteId satellite, const GlonassStrings& strings, int channel, Time now);
    void add(const gnss::KeplerEphemeris& ephemeris);

    gnss::Navigation& navigation_;
    std::map<gnss::SatelliteId, GpsFrames> gps_;
    std::map<gnss::SatelliteId, CnavMessages> cnav_;
    std::map<gnss::SatelliteId, GalileoWords> galileo_;
    std::map<gnss::SatelliteId, FnavPages> fnav_;
    std::map<gnss::SatelliteId, BeiDouFrames> beidou_;
    std::map<gnss::SatelliteId, GlonassStrings> glonass_;
};

}  // namespace schuler::io::detail
