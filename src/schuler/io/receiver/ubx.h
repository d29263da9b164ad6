// Logs of u-blox receivers: raw measurements, navigation messages of the satellites, the receiver's own fixes.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"
#include "schuler/io/rinex/rinex.h"

#include <optional>
#include <vector>

namespace schuler::io {

struct UbxLog {
    gnss::ObservationLog observations;  ///< of RXM-RAWX
    gnss::Navigation navigation;        ///< of RXM-SFRBX: GPS and QZSS LNAV, Galileo I/NAV, BeiDou D1 and D2, GLONASS
    std::vector<GnssFix> fixes;         ///< of NAV-PVT with a fix, in GPS time
    RecordCounts records;               ///< messages; first_bad_line is a byte offset
    std::size_t empty_epochs = 0;       ///< RAWX without measurements
    std::size_t unknown_signals = 0;    ///< measurements of unsupported satellites or signals
};

enum class UbxContent { All, Fixes };  ///< Fixes: satellites' messages are checked and counted, not decoded

/// Reads a log in one pass [UBloxF9]: RXM-RAWX, RXM-SFRBX, NAV-PVT; other messages are counted as foreign, other bytes (NMEA
/// between them) ignored. A message with a wrong checksum or length is skipped and reported with its byte offset. An epoch with
/// an absurd week or not later than the previous one is omitted. @throws Error(Input): no UBX message, no usable one.
[[nodiscard]] UbxLog read_ubx(const TextInput& input, WarningLog& log, UbxContent content = UbxContent::All);

/// The satellite of a receiver's gnssId and svId [UBloxF9:1.5], also used by gpsd; none beyond the numbers of its system.
[[nodiscard]] std::optional<gnss::SatelliteId> ubx_satellite(int gnss_id, int number);

/// True if the first bytes contain a UBX message with a correct checksum. Never throws on content.
[[nodiscard]] bool is_ubx(const TextInput& input);

}  // namespace schuler::io
