// Fixes from raw measurements: the files a data set names, solved epoch by epoch.
#pragma once

#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::dataset {

/// Single-point fixes in GPS time since 1980 from the files of config.raw, whose relative paths start at `folder`. Epochs without
/// a solution are counted in the log by their reason. @throws Error(Input): a file that cannot be read, no fix at all.
[[nodiscard]] std::vector<GnssFix> fixes_from_raw(const std::filesystem::path& folder, const RawGnssConfig& raw,
                                                  WarningLog& warnings);

/// Warns where broadcast coefficients are needed and there are none.
void warn_of_missing_ionosphere(const gnss::BroadcastIonosphere& ionosphere, const RawGnssConfig& raw, WarningLog& warnings);

/// A solved epoch as a fix.
[[nodiscard]] GnssFix fix_from(const gnss::SinglePointSolution& solution);

}  // namespace schuler::dataset
