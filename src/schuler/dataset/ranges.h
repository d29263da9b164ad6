// Ranges of a data set: its ranges.csv, or a receiver's raw measurements with the satellites they were made to; fixes from them.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"
#include "schuler/gnss/single_point.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <vector>

namespace schuler::dataset {

/// Reads [stations] file with its coordinates. Satellites whose place the file does not give come from the navigation files, for which
/// [time] week gives the GPS time of the axis. Samples without a known transmitter are left out and counted.
/// @throws Error(Input) where a file cannot be read.
[[nodiscard]] RangingLog ranges_from_csv(const std::filesystem::path& folder, const Description& description,
                                         WarningLog& warnings);

/// A receiver's raw measurements as ranges free of satellite clocks, in GPS time, with the ionosphere that was broadcast.
struct RawRanges {
    RangingLog log;
    gnss::BroadcastIonosphere ionosphere;
};
[[nodiscard]] RawRanges ranges_from_raw(const std::filesystem::path& folder, const Description& description,
                                        WarningLog& warnings);

/// Fixes of satellites' ranges with what their errors are by the geometry, north, east, down, one sigma.
struct RangeFixes {
    std::vector<GnssFix> fixes;                        ///< they state the sigma of the whole error
    Eigen::Vector3d slow = Eigen::Vector3d::Zero();    ///< m, of the slow errors: median over the fixes
    Eigen::Vector3d change = Eigen::Vector3d::Zero();  ///< m, by which those jump with the set of satellites: median; 0: it stays
};
/// Epoch by epoch, where there are enough ranges: start-up and the other schemes need them. `slow`: m, one sigma of the slow error of a
/// range; 0: not known.
[[nodiscard]] RangeFixes fixes_from_ranges(const RangingLog& log, const std::optional<gnss::BroadcastIonosphere>& ionosphere,
                                           const gnss::SinglePointSettings& settings, double slow);

}  // namespace schuler::dataset
