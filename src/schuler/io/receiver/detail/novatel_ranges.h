// Measurements of RANGE and RANGECMP in the units of RANGE. Private to the reader of raw measurements.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/gnss/satellite.h"
#include "schuler/io/receiver/detail/novatel_frames.h"

#include <cstdint>
#include <optional>

namespace schuler::io::detail {

struct NovatelRange {
    gnss::SatelliteId satellite;
    std::optional<gnss::Signal> signal;           ///< none: not known, as then the satellite may be
    std::optional<int> channel;                   ///< frequency number, where the record has one
    double psr = not_given, adr = not_given;      ///< m, cycles; the latter falls as the range grows
    double doppler = not_given, cn0 = not_given;  ///< Hz, dB-Hz
    float locked = 0.0F;                          ///< s
    std::uint32_t status = 0;                     ///< of the channel
};

/// A satellite by NovAtel's numbers of system and satellite.
[[nodiscard]] std::optional<gnss::SatelliteId> satellite_of(unsigned system, int prn);

[[nodiscard]] NovatelRange range_of(NovatelFields& fields);

/// A record of 24 bytes, packed from the lowest bit on [NovAtelOEM7:RANGECMP]. The accumulated phase has lost multiples of 2^23
/// cycles, which the pseudorange gives. Old firmware leaves all frequency numbers zero, which is channel -7 else: none is given then.
[[nodiscard]] NovatelRange compressed_range_of(NovatelFields& fields);

}  // namespace schuler::io::detail
