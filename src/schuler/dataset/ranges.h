// Ranges of a data set: its ranges.csv, or a receiver's raw measurements with the corresponding satellites; fixes from them.
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

/// Reads [stations] file with its coordinates. Satellites without positions in the file come from the navigation files, for which
/// [time] week gives the GPS time of the axis. Samples without a known transmitter are ignored and counted. @throws Error(Input)
/// if a file cannot be read.
[[nodiscard]] RangingLog ranges_from_csv(const std::filesystem::path& folder, const Description& description,
                                         WarningLog& warnings);

/// A receiver's raw measurements as ranges corrected for satellite clocks, in GPS time, with the broadcast ionosphere.
struct RawRanges {
    RangingLog log;
    gnss::BroadcastIonosphere ionosphere;
    double phase_span = 0.0;    ///< s, usual interval of the range rates from phases; 0: none
    double phase_change = 0.0;  ///< m, gnss::phase_change_sigma; NaN: not known
};
/// `phase_rates`: range rates are the changes of the carrier phases since the epoch before where the count of cycles goes on and
/// does not contradict the Doppler by much.
[[nodiscard]] RawRanges ranges_from_raw(const std::filesystem::path& folder, const Description& description, bool phase_rates,
                                        WarningLog& warnings);

/// Ranges relative to a base, and at the epochs without them the receiver's own, as other sources: their errors are others.
[[nodiscard]] RangingLog with_own(RangingLog relative, const RangingLog& own);

/// Fixes from satellite ranges with their errors due to the geometry, north, east, down, one sigma.
struct RangeFixes {
    std::vector<GnssFix> fixes;                        ///< with the sigma of the total error
    Eigen::Vector3d slow = Eigen::Vector3d::Zero();    ///< m, of the slow errors: median over the fixes
    Eigen::Vector3d change = Eigen::Vector3d::Zero();  ///< m, jump of these with a change of the satellites: median; 0: none
    Eigen::Vector3d slow_velocity = Eigen::Vector3d::Zero();  ///< m/s, of the slow errors of the rates: median over the fixes
};
/// For each epoch with enough ranges: required by start-up and the other schemes. `slow`: m, one sigma of the slow error of a
/// range, 0: unknown; `slow_rate`: m/s, of that of a range rate beyond its stated sigma.
[[nodiscard]] RangeFixes fixes_from_ranges(const RangingLog& log, const std::optional<gnss::BroadcastIonosphere>& ionosphere,
                                           const gnss::SinglePointSettings& settings, double slow, double slow_rate);

}  // namespace schuler::dataset
