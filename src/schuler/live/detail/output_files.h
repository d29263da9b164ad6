// The files of a live run are appended to: only what such a run has written itself, and no source of it.
#pragma once

#include "schuler/live/settings.h"

namespace schuler::live::detail {

/// @throws Error(Input) where an output, the log or the state is a source of the run, or an existing file of another kind
void check_output_files(const LiveSettings& settings);

}  // namespace schuler::live::detail
