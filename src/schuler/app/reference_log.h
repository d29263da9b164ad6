// Truth or another program's solution from a file or a stream of a log.
#pragma once

#include "schuler/app/config.h"
#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/text_input.h"

#include <vector>

namespace schuler::app {

/// CSV with names, solution.csv, or a table of ten columns without them (time, latitude, longitude, height, velocity NED, roll, pitch,
/// heading in degrees). @throws Error(Input).
[[nodiscard]] std::vector<ReferenceSample> read_reference_log(const io::TextInput& input, const FileSource& source, const Config& config,
                                                              WarningLog& warnings);

}  // namespace schuler::app
