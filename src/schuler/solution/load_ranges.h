// Preparation of a data set's ranges for the filter.
#pragma once

#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"

#include <set>
#include <string>

namespace schuler::solution {

/// Tight coupling with a base: the ranges become those relative to it, with carrier phases whose ambiguities are states.
void take_ranges_to_base(LoadedDataset& data, WarningLog& warnings);

/// The receiver's raw measurements as ranges corrected for satellite clocks, in GPS time; sets the corresponding corrections of
/// the filter. `given`: keys whose values are kept.
[[nodiscard]] RangingLog ranges_from_raw(const std::filesystem::path& folder, settings::Config& config,
                                         const std::set<std::string>& given, WarningLog& warnings);

/// Adds fixes computed from its ranges to the recording. If the slow error of the ranges is given (ranges.correlated_m) but not
/// that of the fixes (gnss.correlated_m), the latter is derived from the former, and recorded as a fact (docs/estimation.md).
void take_fixes_from_ranges(LoadedDataset& data);

}  // namespace schuler::solution
