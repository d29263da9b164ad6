// Rate of a commanded channel from its tracked phase.
#pragma once

#include "schuler/receiver/deep_channel.h"

#include <optional>

namespace schuler::receiver {

/// Phases at both ends of an interval determine the mean rate far better than the rotations within its symbols, which are mostly
/// noise. Therefore no rate is delivered within an interval; if the phase is lost, the rates of the symbols are used. The
/// intervals of all channels should end together, so that no correction of the navigation falls within one.
class RateSpan {
public:
    struct Rate {
        double rate = 0.0;      ///< m/s, predicted minus received, a mean over `duration`; by phase: as received
        double variance = 0.0;  ///< (m/s)^2
        double duration = 0.0;  ///< s
        double phase_variance =
            0.0;               ///< m^2, of the phases at the end and, about equal, at the start; 0: by the symbols' own rates
        bool goes_on = false;  ///< the initial phase is the final one of the last rate
    };
    /// A symbol's measurement, in time order. `now`: time of reading, s, at most a symbol after its end; `generated`: the carrier
    /// generated until then, m of range. `ends`: the interval ends as well, and the next starts. The received phase is the
    /// generated one minus the lead found in the symbol, irrespective of commands in between.
    std::optional<Rate> add(const ChannelMeasurement& symbol, double now, double generated, bool ends);
    /// No measurement was made.
    void reset() { *this = {}; }

private:
    [[nodiscard]] Rate of_symbols() const { return {weighted_ / weight_, 1.0 / weight_, duration_, 0.0, false}; }

    bool open_ = false, by_phase_ = false;                         ///< by_phase_: the last rate was by phase
    double begin_ = 0.0, carrier_ = 0.0, carrier_variance_ = 0.0;  ///< s, m, m^2
    double generated_ = 0.0;                                       ///< m
    double weight_ = 0.0, weighted_ = 0.0, duration_ = 0.0;        ///< of the symbols' own rates
};

}  // namespace schuler::receiver
