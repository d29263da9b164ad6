#include "schuler/receiver/rate_span.h"

#include <cmath>

namespace schuler::receiver {

std::optional<RateSpan::Rate> RateSpan::add(const ChannelMeasurement& symbol, double now, double generated, bool ends) {
    const bool coherent = symbol.status == ChannelMeasurement::Status::Coherent;
    weight_ += 1.0 / symbol.rate_variance;
    weighted_ += symbol.rate / symbol.rate_variance;
    duration_ += symbol.duration;
    if (open_ && coherent && !ends) return std::nullopt;
    Rate out = of_symbols();
    if (open_ && coherent) {
        constexpr double agree = 4.0;  // sigmas
        const double duration = now - begin_, ahead = symbol.carrier - carrier_;
        const double variance = (symbol.carrier_variance + carrier_variance_) / (duration * duration);
        // a slipping phase gives no information about the rate
        if (std::abs(ahead / duration - out.rate) < agree * std::sqrt(variance + out.variance))
            out = {(generated - generated_ - ahead) / duration, variance, duration, symbol.carrier_variance, by_phase_};
    }
    by_phase_ = out.phase_variance > 0.0;
    weight_ = weighted_ = duration_ = 0.0;
    open_ = coherent && (open_ || ends);
    begin_ = now;
    generated_ = generated;
    carrier_ = symbol.carrier;
    carrier_variance_ = symbol.carrier_variance;
    return out;
}

}  // namespace schuler::receiver
