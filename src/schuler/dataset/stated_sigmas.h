// Standard deviations stated by the rows of a log: those that no instrument has, and single ones far below the log's own.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"

namespace schuler::dataset {

/// Sigmas of headings, speeds and ranges that are zero, negative or smaller than any such instrument's are removed: the row has the
/// sigma of rows that state none (that of the settings). Of headings and speeds, sigmas below half of the tenth percentile of their log
/// are raised to it: a few rows that claim to be far better than the others would outweigh them all. Both are warned of.
void check_stated_sigmas(Recording& recording, WarningLog& warnings);

}  // namespace schuler::dataset
