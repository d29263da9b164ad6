// Pseudoranges and range rates to transmitters of known position: satellites and ground stations, by epoch. NaN is "not given".
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/time.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace schuler {

/// The transmitter of a range: a satellite by its RINEX name ("G05"), or else a ground station ("ADSB-URKK").
struct RangeSource {
    std::string name;
    bool station = false;
};

/// One source at one epoch. The transmitter's position is that at transmission, in Earth-fixed axes of that instant.
struct RangeSample {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();

    std::uint16_t source = 0;            ///< index into RangingLog::sources
    double pseudorange = none;           ///< m, as received: includes clock errors and delays
    double range_rate = none;            ///< m/s, likewise
    double std = none, std_rate = none;  ///< one sigma of the white part, m, m/s
    /// If the rate is the change of a tracked phase over the last `phase_span` s: one sigma of the phase at either end, m. None: the
    /// rate is not derived from a phase and applies to the epoch itself.
    double phase_std = none, phase_span = none;
    double doppler_rate =
        none;  ///< m/s, used instead of the rate of a phase where the position at the start of its span is unknown
    bool phase_goes_on = false;  ///< the span begins where the last rate of this source ended, so both share that phase
    double cn0 = none;           ///< dB-Hz
    Ecef tx{Eigen::Vector3d::Constant(none)};                       ///< m
    Eigen::Vector3d tx_velocity = Eigen::Vector3d::Constant(none);  ///< m/s, relative to the Earth
    double tx_clock = 0.0;                                          ///< s, transmitter minus system time, hardware delays removed
    double tx_clock_rate = 0.0;                                     ///< s/s
    double frequency = 0.0;                                         ///< Hz, carrier, for the ionosphere; 0: ionosphere-free
    double variance = 0.0;                                          ///< m^2, of orbit and clock
    double noise = 1.0;  ///< factor on the white sigma if none is stated, due to combining signals
    /// Less what a base station measured of the same satellite, and less the air's delay: `variance` is of what is left of both.
    bool differential = false;
};

/// Carrier phase of a source at one epoch, less that of a base station and less the air's delay: its pseudorange with an ambiguity.
struct CarrierSample {
    std::uint16_t source = 0;  ///< index into RangingLog::sources; its sample at the same epoch has the transmitter
    std::uint8_t carrier = 0;  ///< number of the carrier, below 8
    int arc = 0;               ///< unchanged while the count of cycles goes on at both receivers
    double phase = 0.0;        ///< m
    double wavelength = 0.0;   ///< m
    /// Ambiguities of one carrier and system differ by a whole number of cycles, or of half cycles.
    bool whole = true, halves = false;
    double elevation = 0.0;  ///< rad
    double variance = 0.0;   ///< m^2, of a single phase
    double repeated = 0.0;   ///< m^2, the part of it that many epochs have in common
};

/// One epoch: a contiguous range of samples.
struct RangeEpoch {
    Time time;  ///< according to the receiver's clock
    std::size_t first = 0, count = 0;
    std::size_t first_carrier = 0, carriers = 0;  ///< in RangingLog::carriers
};

/// All epochs, in time order.
struct RangingLog {
    std::vector<RangeSource> sources;
    std::vector<RangeEpoch> epochs;
    std::vector<RangeSample> samples;
    std::vector<CarrierSample> carriers;
    Duration to_gps{};  ///< GPS time minus that of the epochs

    [[nodiscard]] std::span<const RangeSample> of(const RangeEpoch& e) const { return {samples.data() + e.first, e.count}; }
    [[nodiscard]] std::span<const CarrierSample> carriers_of(const RangeEpoch& e) const {
        return {carriers.data() + e.first_carrier, e.carriers};
    }
    [[nodiscard]] bool empty() const { return epochs.empty(); }
    /// Index of a source, which is added if not yet known.
    [[nodiscard]] std::uint16_t source(const std::string& name, bool station) {
        for (std::size_t i = 0; i < sources.size(); ++i)
            if (sources[i].name == name) return static_cast<std::uint16_t>(i);
        sources.push_back({name, station});
        return static_cast<std::uint16_t>(sources.size() - 1);
    }
};

}  // namespace schuler
