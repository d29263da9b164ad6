// The speeds of an odometer compared with those of the receiver: unit, scale and clock.
#pragma once

#include "schuler/core/samples.h"

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace schuler::dataset {

struct OdometerAgreement {
    double ratio = 1.0;              ///< speed of the receiver per speed of the odometer
    double lag = 0.0;                ///< s by which the odometer's stamps are late; 0 if the log does not show it
    double spread = 0.0;             ///< m/s, median absolute difference with this ratio and lag
    double spread_as_stamped = 0.0;  ///< likewise without the lag
    std::size_t pairs = 0;
};

/// Compares horizontal speeds of fixes (at their time of validity, less `velocity_latency`, s) with the absolute values of the
/// odometer's. None if there are too few or too uniform speeds, or the two do not belong together with any lag up to two seconds.
[[nodiscard]] std::optional<OdometerAgreement> compare_odometer(const std::vector<OdometerSample>& odometer,
                                                                const std::vector<GnssFix>& fixes, double velocity_latency);

/// The unit in which speeds with that ratio were logged.
struct SpeedUnit {
    std::string_view name;
    double factor;  ///< m/s
};
[[nodiscard]] std::optional<SpeedUnit> unit_of_ratio(double ratio);

}  // namespace schuler::dataset
