// The files of a live run are appended to: only files written by such a run, and none of its sources.
#pragma once

#include "schuler/live/settings.h"

namespace schuler::live::detail {

/// @throws Error(Input) if an output, the log or the state file is a source of the run, or an existing file of another kind
void check_output_files(const LiveSettings& settings);

}  // namespace schuler::live::detail
