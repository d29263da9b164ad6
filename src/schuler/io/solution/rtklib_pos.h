// Solutions of the RTKLIB programs (.pos files).
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/io/text/text_input.h"

#include <string>
#include <string_view>
#include <vector>

namespace schuler::io {

/// A solution as GNSS fixes in GPS time.
struct RtklibPos {
    std::vector<GnssFix> fixes;
    HeightKind height =
        HeightKind::Unstated;  ///< according to the header: ellipsoidal, or geodetic (then Msl); ellipsoidal for Earth-fixed
    std::string time_system = "GPST";  ///< of the file: GPST, UTC or JST
    bool header_found = false;         ///< false: the columns were guessed, with a warning
    RowCounts rows;
};

/// Reads degrees, degrees-minutes-seconds or Earth-fixed coordinates; calendar or week and seconds; GPST, UTC, JST; any field
/// separator; standard deviations and velocities if present. Earth-fixed covariances are converted to sigmas north, east, down.
/// Unreadable rows are skipped and counted (the first line is reported in the log). Throws Error(Input): a file of baselines
/// (east, north, up), no usable row, more than half of the rows unusable.
[[nodiscard]] RtklibPos read_rtklib_pos(const TextInput& input, WarningLog& log);

/// True if the first lines have this format. Never throws on content.
[[nodiscard]] bool is_rtklib_pos(const TextInput& input);

}  // namespace schuler::io
