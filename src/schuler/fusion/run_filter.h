// A run of any scheme: preparation, start-up, forward filter, smoother.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/filter/update/receiver_in_loop.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <functional>
#include <span>

namespace schuler::fusion {

/// Throws Error(Input) where settings and recording cannot give a run: settings out of range, logs without time in common, no fix to
/// start from.
void check_input(const Recording& recording, const Settings& settings, WarningLog& warnings);

/// Reports progress in [0, 1]; called at most some hundred times a run.
using Progress = std::function<void(double)>;

/// Takes the rows of the forward solution in their order, some hundred at a time, while the filter goes on.
using RowSink = std::function<void(std::span<const SolutionRow>)>;

/// Fuses one recording with the scheme of the settings. Where `rows` is given the forward rows go there and of them only the first
/// and the last are in the result: a long log at every epoch then needs no memory for them. Throws Error(Input) where the data
/// cannot be used (no overlap, no fixes, no start) and Error(Computation) where the filter diverges (time and channel named).
/// `receiver`: takes part in a tight, medium or deep run, whose ranges are then its own and not the recording's. Deep needs one.
[[nodiscard]] Result run_filter(const Recording& recording, const Settings& settings, WarningLog& warnings,
                                const Progress& progress = {}, const RowSink& rows = {}, const ReceiverInLoop& receiver = {});

}  // namespace schuler::fusion
