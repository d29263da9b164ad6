// User settings for ranges in the filter.
#pragma once

#include "schuler/filter/integer_search.h"
#include "schuler/gnss/ranges.h"
#include "schuler/sensor/range_errors.h"

#include <memory>
#include <optional>

namespace schuler::filter {

/// Monitoring for wrong pseudoranges that no single epoch reveals, and protection levels (filter/integrity/fault_watch.h). The
/// stated risk: with a constant error of any size in one pseudorange from any time on, the position error exceeds its protection
/// level without an alarm with a probability of at most `missed_detection` at an epoch; without a fault, `fault_free`.
struct ProtectionSettings {
    bool use = false;
    double missed_detection = 1e-3;  ///< as in RAIM [RTCA229]
    double false_alarm = 1e-7;       ///< of one test of a fault-free source; about ten tests per source and epoch
    double fault_free = 1e-7;
};

struct RangingFilterSettings {
    sensor::RangingErrorModel errors;                     ///< white parts if not stated in the log; correlated ones are states
    gnss::RangeSettings corrections;                      ///< mask, atmosphere, increase of the noise towards the horizon
    std::optional<gnss::BroadcastIonosphere> ionosphere;  ///< not given: no ionosphere
    bool sigma_by_elevation = false;                      ///< if not stated in the log: the sigma increases towards the horizon
    /// The initial sigma of a satellite's slow error is that of the atmosphere and ephemeris models' residuals instead of that in `errors`.
    bool slow_by_model = false;
    bool use_rates = true;
    bool use_stations = true;
    ProtectionSettings protection;
    double phase_change_std = 0.005;  ///< m, of the change of a satellite's carrier phase between two epochs, at the zenith
    double timing_std = 0.005;        ///< s, of the time of the ranges by the clock of the IMU, from epoch to epoch
    double code_correlation = 60.0;   ///< s, slow_by_model: of reflections in a satellite's codes
    double phase_correlation = 30.0;  ///< s: of successive carrier phases of a satellite
    double ambiguity_walk = 2e-4;     ///< m/sqrt(s), keeps ambiguities from becoming overconfident
    std::shared_ptr<const IntegerSearch> integers;  ///< null: ambiguities remain real-valued
    double receiver_acceleration = 3.0;  ///< m/s/sqrt(s), intermediate: white acceleration assumed by the receiver's own filter
};

}  // namespace schuler::filter
