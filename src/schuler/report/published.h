// Numbers that somebody has published for a scenario, to stand beside those of a run.
#pragma once

#include "schuler/settings/scenario/published.h"
#include "schuler/solution/state_errors.h"

#include <string>
#include <vector>

namespace schuler::report {

/// Of the rows from `settled` on.
[[nodiscard]] settings::BlockRms rms_of(const std::vector<solution::StateErrors>& states, Time settled);

/// The table for people; empty where nothing is published. `heading`: what `ours` is.
[[nodiscard]] std::string published_table(const settings::Published& published, const settings::BlockRms& ours,
                                          const std::string& heading);

}  // namespace schuler::report
