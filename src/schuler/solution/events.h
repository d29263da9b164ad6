// The solution at user-specified instants.
#pragma once

#include "schuler/core/log.h"
#include "schuler/solution/bundle.h"

#include <vector>

namespace schuler::solution {

/// The solution at each event of the data, in the order of its file; all except the time is NaN outside the solution.
struct EventRows {
    std::vector<NamedInstant> events;
    std::vector<SolutionRow> rows;
    std::vector<NamedInstant> outside;
};
[[nodiscard]] EventRows event_rows(const ResultBundle& bundle);
/// Warns of events outside the solution, with their line numbers.
void warn_of_events_outside(const ResultBundle& bundle, WarningLog& warnings);

/// Removes settings that require the navigation filter: output point, events, and unless the command has its own, the backward
/// filter; with a warning each.
[[nodiscard]] std::vector<Ignored> leave_out_chosen(LoadedDataset& data, bool has_backward = false);

}  // namespace schuler::solution
