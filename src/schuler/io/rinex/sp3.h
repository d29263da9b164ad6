// Precise orbits and clocks: SP3-a to SP3-d files.
#pragma once

#include "schuler/core/log.h"
#include "schuler/gnss/satellite_source.h"
#include "schuler/io/rinex/rinex.h"

#include <vector>

namespace schuler::io {

struct Sp3File {
    std::vector<std::vector<gnss::PreciseSource::Node>> nodes;  ///< by gnss::index_of, in order of time (GPS)
    std::size_t epochs = 0;
    RecordCounts records;  ///< position lines
};

/// Reads position records; absent positions (zeros) are omitted, absent clocks (999999.999999) are NaN. Also gz-compressed.
/// @throws Error(Input): not an SP3 file, no usable position.
[[nodiscard]] Sp3File read_sp3(const TextInput& input, WarningLog& log);

}  // namespace schuler::io
