// Logs of u-blox receivers: raw measurements, the satellites' messages, the receiver's own fixes.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"
#include "schuler/io/rinex/rinex.h"

#include <vector>

namespace schuler::io {

struct UbxLog {
    gnss::ObservationLog observations;  ///< of RXM-RAWX
    gnss::Navigation navigation;        ///< of RXM-SFRBX: GPS and QZSS LNAV, Galileo I/NAV, BeiDou D1 and D2, GLONASS
    std::vector<GnssFix> fixes;         ///< of NAV-PVT with a fix, in GPS time
    RecordCounts records;               ///< messages; first_bad_line is a byte offset
    std::size_t empty_epochs = 0;       ///< RAWX without measurements
    std::size_t unknown_signals = 0;    ///< measurements of satellites or signals that have no place here
};

/// Reads a log in one pass [UBloxF9]: RXM-RAWX, RXM-SFRBX, NAV-PVT; other messages are counted as foreign, other bytes (NMEA between
/// them) passed over. A wrong checksum or length skips the message and is told with its byte offset. An epoch whose week is absurd
/// or that is not later than the one before is left out. @throws Error(Input): no UBX message, none of use.
[[nodiscard]] UbxLog read_ubx(const TextInput& input, WarningLog& log);

/// Whether the first bytes have a UBX message with a right checksum. Never throws on content.
[[nodiscard]] bool is_ubx(const TextInput& input);

}  // namespace schuler::io
