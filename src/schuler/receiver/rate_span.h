// Rate of a commanded channel from the phase that it follows.
#pragma once

#include "schuler/receiver/deep_channel.h"

#include <optional>

namespace schuler::receiver {

/// Phases at both ends of a span tell the mean rate between them far better than the turns within its symbols, which are noise
/// mostly. So no rate leaves within a span; where the phase is lost, what the symbols said meanwhile does. The spans of all
/// channels should end together, as then no correction of the navigation falls into one.
class RateSpan {
public:
    struct Rate {
        double rate = 0.0;      ///< m/s, predicted minus received, a mean over `duration`; by phase: as received
        double variance = 0.0;  ///< (m/s)^2
        double duration = 0.0;  ///< s
        double phase_variance =
            0.0;               ///< m^2, of the phase at the span's end, and about that at its begin; 0: the symbols' own rates
        bool goes_on = false;  ///< the phase at its begin is that of the end of the last rate
    };
    /// A symbol's measurement, in order of time. `now`: when it is read, s, a symbol after its end at most; `generated`: the carrier
    /// that the generator has made until then, m of range. `ends`: so does the span, and the next begins. The phase that was received is the
    /// generated one less what the symbol found it ahead, whatever was commanded meanwhile.
    std::optional<Rate> add(const ChannelMeasurement& symbol, double now, double generated, bool ends);
    /// Nothing was measured.
    void reset() { *this = {}; }

private:
    [[nodiscard]] Rate of_symbols() const { return {weighted_ / weight_, 1.0 / weight_, duration_, 0.0, false}; }

    bool open_ = false, by_phase_ = false;                         ///< by_phase_: the last rate was
    double begin_ = 0.0, carrier_ = 0.0, carrier_variance_ = 0.0;  ///< s, m, m^2
    double generated_ = 0.0;                                       ///< m
    double weight_ = 0.0, weighted_ = 0.0, duration_ = 0.0;        ///< of the symbols' own rates
};

}  // namespace schuler::receiver
