// Published results for a scenario, for comparison with those of a run.
#pragma once

#include "schuler/settings/scenario/published.h"
#include "schuler/solution/state_errors.h"

#include <string>
#include <vector>

namespace schuler::report {

/// For the rows from `settled` on.
[[nodiscard]] settings::BlockRms rms_of(const std::vector<solution::StateErrors>& states, Time settled);

/// The table as readable text; empty if nothing is published. `heading`: the meaning of `ours`.
[[nodiscard]] std::string published_table(const settings::Published& published, const settings::BlockRms& ours,
                                          const std::string& heading);

}  // namespace schuler::report
