// What a user can set about ranges in the filter.
#pragma once

#include "schuler/gnss/ranges.h"
#include "schuler/sensor/range_errors.h"

#include <optional>

namespace schuler::filter {

/// Watch for wrong pseudoranges that no single epoch shows, and protection levels (filter/fault_watch.h). The stated risk: with one
/// satellite's pseudorange wrong by a constant of any size since any moment, the error of the position exceeds its protection level
/// without an alarm with a probability of at most `missed_detection` at an epoch; without a fault it does so with `fault_free`.
struct ProtectionSettings {
    bool use = false;
    double missed_detection = 1e-3;  ///< as in RAIM [RTCA229]
    double false_alarm = 1e-7;       ///< of one test of a healthy source; some ten tests a source and epoch
    double fault_free = 1e-7;
};

struct RangingFilterSettings {
    sensor::RangingErrorModel errors;                     ///< white parts where the log states none; correlated ones are states
    gnss::RangeSettings corrections;                      ///< mask, atmosphere, growth of the noise towards the horizon
    std::optional<gnss::BroadcastIonosphere> ionosphere;  ///< not given: there is none
    bool sigma_by_elevation = false;                      ///< where the log states none: the sigma grows towards the horizon
    /// The slow error of a satellite begins with the sigma of what the atmosphere's models and the ephemeris leave instead of that of `errors`.
    bool slow_by_model = false;
    bool use_rates = true;
    bool use_stations = true;
    ProtectionSettings protection;
    double receiver_acceleration = 3.0;  ///< m/s/sqrt(s), medium: white acceleration that the receiver's own filter expects
};

}  // namespace schuler::filter
