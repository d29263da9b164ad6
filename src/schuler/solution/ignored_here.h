// Settings of the command line among those without effect: what its user has just written is not hidden behind the keys of a file.
#pragma once

#include "schuler/core/log.h"
#include "schuler/settings/value.h"
#include "schuler/solution/ignored.h"

#include <vector>

namespace schuler::solution {

/// Adds filter.self_check if the command line asks for it: only `schuler process` checks itself, and as the default it does not differ from
/// a setting that was not given.
void add_unmade_check(std::vector<Ignored>& ignored, const settings::SettingList& command_line);

/// As warn_of_ignored, but first, and all of them, the keys of the command line.
void warn_of_ignored_here(const std::vector<Ignored>& ignored, const settings::SettingList& command_line, WarningLog& warnings);

}  // namespace schuler::solution
