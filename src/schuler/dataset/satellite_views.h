// A receiver's satellites by epoch: single-point solutions with the status of every satellite, and carrier phases relative to a base.
#pragma once

#include "schuler/core/log.h"
#include "schuler/dataset/carrier_phase.h"
#include "schuler/dataset/description.h"
#include "schuler/gnss/epoch_view.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace schuler::dataset {

struct ViewSpan {
    std::optional<double> start, stop;  ///< s after the first epoch; empty: no limit
};

struct SatelliteViews {
    std::vector<gnss::EpochView> epochs;  ///< in time order
    std::optional<CarrierPhase> carrier;  ///< if there is a base, with EpochSolution::signals
};

/// From the raw measurements of the description, or from its table of ranges. `progress` may be empty.
/// @throws Error(Input): a file that cannot be read, no ephemerides, no epoch, a base that does not belong to the rover.
[[nodiscard]] SatelliteViews satellite_views(const std::filesystem::path& folder, const Description& description,
                                             const ViewSpan& span, double missed_detection,
                                             const std::function<void(double)>& progress, WarningLog& warnings);

}  // namespace schuler::dataset
