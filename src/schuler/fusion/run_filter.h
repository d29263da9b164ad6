// A run with any scheme: preparation, start-up, forward filter, smoother.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/filter/update/receiver_in_loop.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <functional>
#include <span>

namespace schuler::fusion {

/// Throws Error(Input) if settings and recording do not permit a run: settings out of range, logs without common time, no fix to
/// start from.
void check_input(const Recording& recording, const Settings& settings, WarningLog& warnings);

/// Reason why these give the motion of the unit only, and not that of the antenna (Settings::output_at_antenna); otherwise null.
[[nodiscard]] const char* only_of_unit(const Recording& recording, const Settings& settings);

/// Reports progress in [0, 1]; called at most about a hundred times per run.
using Progress = std::function<void(double)>;

/// Receives the rows of the forward solution in order, about a hundred at a time, while the filter continues.
using RowSink = std::function<void(std::span<const SolutionRow>)>;

/// Processes one recording with the scheme of the settings. If `rows` is given, it receives the forward rows and the result has
/// only the first and the last of them, to save memory for a long log at every epoch. Throws Error(Input) if the data cannot be
/// used (no overlap, no fixes, no start) and Error(Computation) if the filter diverges (with time and channel). `receiver`: takes
/// part in a tight, intermediate or deep run, whose ranges are then its own and not the recording's. Required for Deep.
[[nodiscard]] Result run_filter(const Recording& recording, const Settings& settings, WarningLog& warnings,
                                const Progress& progress = {}, const RowSink& rows = {}, const ReceiverInLoop& receiver = {});

}  // namespace schuler::fusion
