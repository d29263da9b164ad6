// Ephemerides from the frames that satellites send, subframe by subframe. Private to the readers.
#pragma once

#include "schuler/gnss/ephemeris.h"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace schuler::io::detail {

/// Collects subframes of GPS and QZSS (LNAV) and pages of Galileo (I/NAV) until an ephemeris is complete and consistent; adds it
/// where it is new. `now` is the receiver's time, within half of the broadcast week counters.
class FrameCollector {
public:
    explicit FrameCollector(gnss::Navigation& navigation) : navigation_(navigation) {}

    /// Ten words of 24 data bits, parity removed [ISGPS200:20.3.3]. False where the frame is none.
    bool gps_subframe(gnss::SatelliteId satellite, const std::array<std::uint32_t, 10>& words, Time now);
    /// Even and odd page part of 120 bits each, left-aligned in four words of 32 bits [GalileoICD:4.3]. False where the check fails.
    bool galileo_page(gnss::SatelliteId satellite, std::span<const std::uint32_t, 8> words, Time now);

private:
    struct GpsFrames {
        std::array<std::string, 3> subframes;
    };
    struct GalileoWords {
        std::array<std::string, 5> words;
    };
    void gps_ephemeris(gnss::SatelliteId satellite, const GpsFrames& frames, Time now);
    void gps_ionosphere(gnss::SatelliteId satellite, const std::string& subframe);
    void galileo_ephemeris(gnss::SatelliteId satellite, const GalileoWords& words, Time now);
    void add(const gnss::KeplerEphemeris& ephemeris);

    gnss::Navigation& navigation_;
    std::map<gnss::SatelliteId, GpsFrames> gps_;
    std::map<gnss::SatelliteId, GalileoWords> galileo_;
};

}  // namespace schuler::io::detail
