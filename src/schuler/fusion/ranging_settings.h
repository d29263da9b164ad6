// What a user can set about ranges in the filter.
#pragma once

#include "schuler/gnss/ranges.h"
#include "schuler/sensor/range_errors.h"

#include <optional>

namespace schuler::fusion {

struct RangingFilterSettings {
    sensor::RangingErrorModel errors;             ///< white parts where the log states none; correlated ones are states
    gnss::RangeSettings corrections;              ///< mask, atmosphere, growth of the noise towards the horizon
    std::optional<gnss::KlobucharCoefficients> klobuchar;
    bool sigma_by_elevation = false;              ///< where the log states none: the sigma grows towards the horizon
    bool use_rates = true;
    bool use_stations = true;
    double baro_bias_time = 0.0;                  ///< s, of the barometer's bias as a Gauss-Markov process; 0: a random walk
};

}  // namespace schuler::fusion
