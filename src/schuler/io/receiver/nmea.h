// NMEA 0183 logs: sentences combined to epochs of a GNSS receiver.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/io/text/text_input.h"

#include <cstddef>
#include <vector>

namespace schuler::io {

/// A log as GNSS fixes.
struct NmeaLog {
    std::vector<GnssFix> fixes;  ///< in GPS time if there is a date, else seconds of the first UTC day
    bool has_date = false;
    HeightKind height = HeightKind::Ellipsoidal;  ///< Msl if the log has no geoid separation
    std::size_t sentences = 0;                    ///< with a correct checksum
    std::size_t bad_sentences = 0;                ///< with a wrong or missing checksum, or damaged fields
    RowCounts rows;
};

/// Reads GGA, RMC, GNS, GST, VTG, GSA and ZDA of any talker; the checksum must be correct; text before '$' and other lines are
/// ignored. Sentences of the same time of day form an epoch; the date is taken from RMC or ZDA and advances at midnight. UTC is
/// converted to GPS time, height above mean sea level plus geoid separation gives ellipsoidal height. Throws Error(Input) if
/// there is no fix.
[[nodiscard]] NmeaLog read_nmea(const TextInput& input, WarningLog& log);

/// True if the first lines contain a sentence with a correct checksum. Never throws on content.
[[nodiscard]] bool is_nmea(const TextInput& input);

}  // namespace schuler::io
