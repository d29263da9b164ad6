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
        double rate = 0.0;      ///< m/s, predicted minus received, a mean over `duration`
        double variance = 0.0;  ///< (m/s)^2
        double duration = 0.0;  ///< s
    };
    /// A symbol's measurement, in order of time; `at`: its end, s. `ends`: so does the span, and the next begins.
    std::optional<Rate> add(const ChannelMeasurement& symbol, double at, bool ends);
    /// Nothing was measured.
    void reset() { *this = {}; }

private:
    [[nodiscard]] Rate of_symbols() const { return {weighted_ / weight_, 1.0 / weight_, duration_}; }

    bool open_ = false;
    double begin_ = 0.0, carrier_ = 0.0, carrier_variance_ = 0.0;  ///< s, m, m^2
    double weight_ = 0.0, weighted_ = 0.0, duration_ = 0.0;        ///< of the symbols' own rates
};

}  // namespace schuler::receiver
