// Settings that were given but cannot have had an effect on a run.
#pragma once

#include "schuler/solution/bundle.h"

#include <set>
#include <string>
#include <vector>

namespace schuler::solution {

/// The given keys that were not used by the run, each with the reason. A value equal to the default is
/// omitted.
[[nodiscard]] std::vector<Ignored> ignored_of(const ResultBundle& bundle, const std::set<std::string>& given);

/// The same for `schuler ahrs`: what attitude filters do not use.
[[nodiscard]] std::vector<Ignored> ignored_by_attitude(const settings::Config& config, const std::set<std::string>& given);

/// One warning per reason, with the keys it applies to.
void warn_of_ignored(const std::vector<Ignored>& ignored, WarningLog& warnings);

}  // namespace schuler::solution
