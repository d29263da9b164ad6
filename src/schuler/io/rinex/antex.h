// Calibrations of antennas: ANTEX 1.x files [ANTEX14].
#pragma once

#include "schuler/core/log.h"
#include "schuler/gnss/antenna.h"
#include "schuler/io/rinex/rinex.h"

namespace schuler::io {

struct AntexFile {
    gnss::Antennas antennas;
    RecordCounts records;  ///< antennas
};

/// Reads offsets and variations of all carriers of known systems; a damaged antenna is skipped and counted. Also gz-compressed.
/// @throws Error(Input): not an ANTEX file, no usable antenna.
[[nodiscard]] AntexFile read_antex(const TextInput& input, WarningLog& log);

}  // namespace schuler::io
