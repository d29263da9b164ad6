// Raw measurements of a receiver, epoch by epoch.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/core/time.h"
#include "schuler/gnss/satellite.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace schuler::gnss {

/// What a receiver measured of one signal of one satellite. NaN where not measured.
struct SignalObservation {
    SatelliteId satellite;
    Signal signal;
    std::uint8_t loss_of_lock = 0;   ///< RINEX indicator of the phase: bit 0 lock lost, bit 1 half-cycle ambiguous
    std::uint8_t strength = 0;       ///< RINEX signal strength digit of the phase, 0 unknown
    double pseudorange = not_given;  ///< m
    double phase = not_given;        ///< cycles, grows with the range
    double doppler = not_given;      ///< Hz, positive where the satellite approaches
    double cn0 = not_given;          ///< dB-Hz
};

/// One epoch: a range of observations, those of one satellite side by side.
struct ObservationEpoch {
    Time time;                         ///< GPS time as the receiver's clock tells it
    bool power_failure = false;        ///< the receiver lost power before it
    std::size_t first = 0, count = 0;  ///< in ObservationLog::observations
};

/// GLONASS frequency number of a slot, or `unknown_channel`.
inline constexpr std::int8_t unknown_channel = 127;
struct GlonassChannels {
    std::array<std::int8_t, numbers_per_system> of_slot;
    GlonassChannels() { of_slot.fill(unknown_channel); }
};

/// A whole log. `approximate` and `antenna_delta` are the header's, NaN where it has none.
struct ObservationLog {
    double version = 0.0;  ///< of RINEX; 0 where it comes from another format
    std::string marker;
    Ecef approximate{not_given3()};
    Eigen::Vector3d antenna_delta = not_given3();  ///< marker to antenna: up, east, north, m
    GlonassChannels channels;
    std::vector<ObservationEpoch> epochs;
    std::vector<SignalObservation> observations;

    [[nodiscard]] std::span<const SignalObservation> of(const ObservationEpoch& e) const {
        return {observations.data() + e.first, e.count};
    }
};

}  // namespace schuler::gnss
