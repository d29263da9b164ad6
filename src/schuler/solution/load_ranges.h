// What ranges of a data set mean for the filter.
#pragma once

#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"

#include <set>
#include <string>

namespace schuler::solution {

/// The receiver's raw measurements as ranges free of satellite clocks, in GPS time; sets what follows for the filter's corrections.
/// `given`: keys whose values stay.
[[nodiscard]] RangingLog ranges_from_raw(const std::filesystem::path& folder, settings::Config& config,
                                         const std::set<std::string>& given, WarningLog& warnings);

/// Gives the recording its fixes from its ranges. Where the ranges' slow error is given (ranges.correlated_m) and that of the fixes is not
/// (gnss.correlated_m), the filter assumes the second as derived from the first, and the facts record it (docs/estimation.md).
void take_fixes_from_ranges(LoadedDataset& data);

}  // namespace schuler::solution
