// Ranges of a data set: its ranges.csv, or a receiver's raw measurements with the satellites they were made to.
#pragma once

#include "schuler/app/dataset.h"

namespace schuler::app {

/// Reads [stations] file with its coordinates. Satellites whose place the file does not give come from the navigation files, for which
/// [time] week says what GPS time the axis has. Samples without a known transmitter are left out and counted.
/// @throws Error(Input) where a file cannot be read.
[[nodiscard]] RangingLog ranges_from_csv(const std::filesystem::path& folder, const Config& config, WarningLog& warnings);

/// The receiver's raw measurements as ranges free of satellite clocks, in GPS time; sets what follows for the filter's corrections.
[[nodiscard]] RangingLog ranges_from_raw(const std::filesystem::path& folder, Config& config, WarningLog& warnings);

/// Fixes of the satellites' ranges, epoch by epoch, where there are enough of them: start-up and the other schemes need them.
[[nodiscard]] std::vector<GnssFix> fixes_from_ranges(const RangingLog& log, const Config& config);

}  // namespace schuler::app
