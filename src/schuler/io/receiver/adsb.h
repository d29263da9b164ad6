// Extended squitters of 1090 MHz from a receiver's log, AVR text or Beast binary, and their positions [RTCA260].
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/position.h"
#include "schuler/core/time.h"
#include "schuler/io/rinex/rinex.h"
#include "schuler/io/text/csv/csv_ranges.h"
#include "schuler/io/text/text_input.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace schuler::io {

/// A reported position. The time is the receiver's 12 MHz counter, zero if not in the log.
struct SquitterPosition {
    std::uint32_t address = 0;  ///< 24 bits, with bit 24 set if it is not an ICAO address
    Time time;
    Geodetic position;              ///< height NaN on the surface or if not reported
    bool geometric_height = false;  ///< above the ellipsoid; otherwise pressure height
    bool surface = false;
};

struct AdsbLog {
    std::vector<SquitterPosition> positions;
    RecordCounts messages;  ///< extended squitters; bad: parity or length
};

/// True if the first bytes are Beast frames or AVR lines. Never throws on content.
[[nodiscard]] bool is_adsb(const TextInput& input);

/// Reads a log. Damaged frames are skipped and counted; positions are computed from an even and an odd message of one address within 10 s,
/// then from one message near the last position; surface positions require `near`. @throws Error(Input): no such log, or no valid message.
[[nodiscard]] AdsbLog read_adsb(const TextInput& input, std::optional<Geodetic> near, WarningLog& log);

/// Addresses that stay within 30 m of their mean over at least five reports, as stations at the mean, named "ADSB-" and the six
/// hexadecimal digits of the address; pressure heights are used unchanged, NaN if none is reported.
[[nodiscard]] std::vector<StationRow> stations_of(const AdsbLog& log);

/// Remainder of a message of 14 bytes relative to its own parity field; 0: valid.
[[nodiscard]] std::uint32_t squitter_parity(std::span<const std::uint8_t, 14> message);

/// Compact position reports: latitude and longitude as 17-bit fractions of a zone.
struct CompactPosition {
    bool odd = false;
    std::uint32_t lat = 0, lon = 0;
};
/// Number of longitude zones at a latitude (rad).
[[nodiscard]] int longitude_zones(double lat);
/// Airborne position from an even and an odd report, at the later one's time; empty if they are in different latitude zones.
[[nodiscard]] std::optional<Geodetic> global_position(const CompactPosition& even, const CompactPosition& odd, bool odd_is_later);
/// Position from one report within half a zone (330 km in the air, 83 km on the surface) of a known position.
[[nodiscard]] Geodetic local_position(const CompactPosition& report, const Geodetic& near, bool surface);

}  // namespace schuler::io
