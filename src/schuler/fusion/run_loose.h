// The loosely coupled run: preparation, start-up, forward filter, smoother.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <functional>

namespace schuler::fusion {

/// Reports progress in [0, 1]; called at most some hundred times a run.
using Progress = std::function<void(double)>;

/// Fuses one recording. Throws Error(Input) where the data cannot be used (no overlap, no fixes, no start) and
/// Error(Computation) where the filter diverges (time and channel named).
[[nodiscard]] Result run_loose(const Recording& recording, const Settings& settings, WarningLog& warnings,
                               const Progress& progress = {});

}  // namespace schuler::fusion
