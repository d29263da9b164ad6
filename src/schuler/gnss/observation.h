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

/// Measurement of one signal of one satellite. NaN if not measured.
struct SignalObservation {
    SatelliteId satellite;
    Signal signal;
    std::uint8_t loss_of_lock = 0;   ///< RINEX indicator of the phase: bit 0 lock lost, bit 1 half-cycle ambiguous
    std::uint8_t strength = 0;       ///< RINEX signal strength digit of the phase, 0 unknown
    double pseudorange = not_given;  ///< m
    double phase = not_given;        ///< cycles, increases with the range
    double doppler = not_given;      ///< Hz, positive for an approaching satellite
    double cn0 = not_given;          ///< dB-Hz
};

/// One epoch: a contiguous range of observations, grouped by satellite.
struct ObservationEpoch {
    Time time;                         ///< GPS time according to the receiver's clock
    bool power_failure = false;        ///< the receiver lost power before this epoch
    std::size_t first = 0, count = 0;  ///< in ObservationLog::observations
};

/// GLONASS frequency number of a slot, or `unknown_channel`.
inline constexpr std::int8_t unknown_channel = 127;
struct GlonassChannels {
    std::array<std::int8_t, numbers_per_system> of_slot;
    GlonassChannels() { of_slot.fill(unknown_channel); }
};

/// A complete log. `approximate` and `antenna_delta` are from the header, NaN if absent.
struct ObservationLog {
    double version = 0.0;  ///< RINEX version; 0 if from another format
    std::string marker;
    Ecef approximate{not_given3()};
    std::string antenna;                           ///< type and radome as in a header, empty if not stated
    Eigen::Vector3d antenna_delta = not_given3();  ///< marker to antenna: up, east, north, m
    GlonassChannels channels;
    std::vector<ObservationEpoch> epochs;
    std::vector<SignalObservation> observations;

    [[nodiscard]] std::span<const SignalObservation> of(const ObservationEpoch& e) const {
        return {observations.data() + e.first, e.count};
    }
};

}  // namespace schuler::gnss
