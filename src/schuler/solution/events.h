// The solution at the instants that a user asks for.
#pragma once

#include "schuler/core/log.h"
#include "schuler/solution/bundle.h"

#include <vector>

namespace schuler::solution {

/// The solution at each event of the data, in the order of its file; all but the time is NaN at those outside the solution.
struct EventRows {
    std::vector<NamedInstant> events;
    std::vector<SolutionRow> rows;
    std::vector<NamedInstant> outside;
};
[[nodiscard]] EventRows event_rows(const ResultBundle& bundle);
/// Names the lines of events outside the solution.
void warn_of_events_outside(const ResultBundle& bundle, WarningLog& warnings);

/// Takes out what only a run of the navigation filter gives: the point, the events, the filter backward in time; with a warning each.
[[nodiscard]] std::vector<Ignored> leave_out_chosen(LoadedDataset& data);

}  // namespace schuler::solution
