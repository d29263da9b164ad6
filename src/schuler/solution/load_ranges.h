// Ranges of a data set: its ranges.csv, or a receiver's raw measurements with the satellites they were made to.
#pragma once

#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"

#include <set>
#include <string>

namespace schuler::solution {

/// Reads [stations] file with its coordinates. Satellites whose place the file does not give come from the navigation files, for which
/// [time] week says what GPS time the axis has. Samples without a known transmitter are left out and counted.
/// @throws Error(Input) where a file cannot be read.
[[nodiscard]] RangingLog ranges_from_csv(const std::filesystem::path& folder, const settings::Config& config, WarningLog& warnings);

/// The receiver's raw measurements as ranges free of satellite clocks, in GPS time; sets what follows for the filter's corrections.
/// `given`: keys whose values stay.
[[nodiscard]] RangingLog ranges_from_raw(const std::filesystem::path& folder, settings::Config& config, const std::set<std::string>& given,
                                         WarningLog& warnings);

/// Fixes of satellites' ranges with what their errors are by the geometry, north, east, down, one sigma.
struct RangeFixes {
    std::vector<GnssFix> fixes;                                ///< they state the sigma of the whole error
    Eigen::Vector3d slow = Eigen::Vector3d::Zero();            ///< m, of the slow errors: median over the fixes
    Eigen::Vector3d change = Eigen::Vector3d::Zero();          ///< m, by which those jump with the set of satellites: median; 0: it stays
};
/// Epoch by epoch, where there are enough ranges: start-up and the other schemes need them. `slow`: m, one sigma of the slow error of a
/// range; 0: not known.
[[nodiscard]] RangeFixes fixes_from_ranges(const RangingLog& log, const settings::Config& config, double slow);

/// Gives the recording its fixes from its ranges. Where the ranges' slow error is given (ranges.correlated_m) and that of the fixes is not
/// (gnss.correlated_m), the filter is told what the first makes of the second, and the facts say so (docs/estimation.md).
void take_fixes_from_ranges(LoadedDataset& data);

}  // namespace schuler::solution
