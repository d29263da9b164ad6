// Settings that were given and cannot have had an effect on a run.
#pragma once

#include "schuler/solution/bundle.h"

#include <set>
#include <string>
#include <vector>

namespace schuler::solution {

/// Of the keys that a user gave, those that the run had no use for, each with the reason. A value equal to the default
/// is left out.
[[nodiscard]] std::vector<Ignored> ignored_of(const ResultBundle& bundle, const std::set<std::string>& given);

/// One warning a reason, with the keys that it holds for.
void warn_of_ignored(const std::vector<Ignored>& ignored, WarningLog& warnings);

}  // namespace schuler::solution
