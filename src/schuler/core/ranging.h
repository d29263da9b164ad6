// Pseudoranges and range rates to points of known place: satellites and ground stations, epoch by epoch. NaN means "not given".
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

/// What ranges are measured to: a satellite by its RINEX name ("G05"), anything else is a ground station ("ADSB-URKK").
struct RangeSource {
    std::string name;
    bool station = false;
};

/// One source at one epoch. The transmitter is where it was when it sent, in Earth-fixed axes of that instant.
struct RangeSample {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();

    std::uint16_t source = 0;            ///< index into RangingLog::sources
    double pseudorange = none;           ///< m, as received: clocks and delays included
    double range_rate = none;            ///< m/s, likewise
    double std = none, std_rate = none;  ///< one sigma of the white part, m, m/s
    /// Where the rate is the change of a followed phase over the last `phase_span` s: one sigma of the phase at either end, m; none: it is not,
    /// and of now.
    double phase_std = none, phase_span = none;
    bool phase_goes_on = false;  ///< that span begins where the last rate of the source ended: the phase there is in both
    double cn0 = none;           ///< dB-Hz
    Ecef tx{Eigen::Vector3d::Constant(none)};                       ///< m
    Eigen::Vector3d tx_velocity = Eigen::Vector3d::Constant(none);  ///< m/s, relative to the Earth
    double tx_clock = 0.0;       ///< s, transmitter minus system time, hardware delays taken off
    double tx_clock_rate = 0.0;  ///< s/s
    double frequency = 0.0;      ///< Hz, of the carrier, for the ionosphere; 0: free of it
    double variance = 0.0;       ///< m^2, of orbit and clock
    double noise = 1.0;          ///< factor on the white sigma where none is stated, from combining signals
};

/// One epoch: a run of samples.
struct RangeEpoch {
    Time time;  ///< as the receiver's clock tells it
    std::size_t first = 0, count = 0;
};

/// All of them, in order of time.
struct RangingLog {
    std::vector<RangeSource> sources;
    std::vector<RangeEpoch> epochs;
    std::vector<RangeSample> samples;

    [[nodiscard]] std::span<const RangeSample> of(const RangeEpoch& e) const { return {samples.data() + e.first, e.count}; }
    [[nodiscard]] bool empty() const { return epochs.empty(); }
    /// Index of a source, added where it is not known yet.
    [[nodiscard]] std::uint16_t source(const std::string& name, bool station) {
        for (std::size_t i = 0; i < sources.size(); ++i)
            if (sources[i].name == name) return static_cast<std::uint16_t>(i);
        sources.push_back({name, station});
        return static_cast<std::uint16_t>(sources.size() - 1);
    }
};

}  // namespace schuler
