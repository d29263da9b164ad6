// A receiver's satellites epoch by epoch: single-point solutions with what became of every satellite, and carrier phases against a base.
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
    std::optional<double> start, stop;  ///< s after the first epoch; nothing: all of it
};

struct SatelliteViews {
    std::vector<gnss::EpochView> epochs;  ///< in order of time
    std::optional<CarrierPhase> carrier;  ///< where there is a base, with EpochSolution::signals
};

/// From the raw measurements of the description, or from its table of ranges. `progress` may be empty.
/// @throws Error(Input): a file that cannot be read, no ephemerides, no epoch, a base that does not belong to the rover.
[[nodiscard]] SatelliteViews satellite_views(const std::filesystem::path& folder, const Description& description,
                                             const ViewSpan& span, double missed_detection,
                                             const std::function<void(double)>& progress, WarningLog& warnings);

}  // namespace schuler::dataset
