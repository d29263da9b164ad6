// NMEA 0183 logs: sentences put together to epochs of a GNSS receiver.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/csv_recording.h"
#include "schuler/io/text/text_input.h"

#include <cstddef>
#include <vector>

namespace schuler::io {

/// A log as GNSS fixes.
struct NmeaLog {
    std::vector<GnssFix> fixes;  ///< in GPS time where there is a date, else seconds of the first UTC day
    bool has_date = false;
    HeightKind height = HeightKind::Ellipsoidal;  ///< Msl where the log gives no geoid separation
    std::size_t sentences = 0;                    ///< with a right checksum
    std::size_t bad_sentences = 0;                ///< with a wrong or missing one, or damaged fields
    RowCounts rows;
};

/// Reads GGA, RMC, GNS, GST, VTG, GSA and ZDA of any talker; the checksum must be right; text in front of '$' and other lines are
/// passed over. Sentences of the same time of day form an epoch; the date comes from RMC or ZDA and turns at midnight. UTC
/// becomes GPS time, height above mean sea level plus geoid separation becomes ellipsoidal height. Throws Error(Input) where
/// there is no fix at all.
[[nodiscard]] NmeaLog read_nmea(const TextInput& input, WarningLog& log);

/// Whether the first lines have a sentence with a right checksum. Never throws on content.
[[nodiscard]] bool is_nmea(const TextInput& input);

}  // namespace schuler::io
