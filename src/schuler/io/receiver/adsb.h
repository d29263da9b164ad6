// Extended squitters of 1090 MHz from a receiver's log, AVR text or Beast binary, and the positions in them [RTCA260].
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/position.h"
#include "schuler/core/time.h"
#include "schuler/io/rinex/rinex.h"
#include "schuler/io/text/csv_ranges.h"
#include "schuler/io/text/text_input.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace schuler::io {

/// A reported position. The time is the receiver's 12 MHz counter, zero where the log has none.
struct SquitterPosition {
    std::uint32_t address = 0;  ///< 24 bits, with bit 24 set where it is no ICAO address
    Time time;
    Geodetic position;              ///< height NaN on the surface or where not told
    bool geometric_height = false;  ///< above the ellipsoid; otherwise by pressure
    bool surface = false;
};

struct AdsbLog {
    std::vector<SquitterPosition> positions;
    RecordCounts messages;  ///< extended squitters; bad: parity or length
};

/// True where the first bytes look like Beast frames or AVR lines. Never throws on content.
[[nodiscard]] bool is_adsb(const TextInput& input);

/// Reads a log. Damaged frames are skipped and counted; positions come from an even and an odd message of one address within 10 s, then
/// from one message near the last position; surface positions need `near`. @throws Error(Input): no such log, or without one good message.
[[nodiscard]] AdsbLog read_adsb(const TextInput& input, std::optional<Geodetic> near, WarningLog& log);

/// Addresses that stay within 30 m of their middle over at least five reports, as stations at that middle, named "ADSB-" and the six
/// hexadecimal digits of the address; heights by pressure are taken as they are, NaN where none is told.
[[nodiscard]] std::vector<StationRow> stations_of(const AdsbLog& log);

/// Remainder of a message of 14 bytes against its own parity field; 0: good.
[[nodiscard]] std::uint32_t squitter_parity(std::span<const std::uint8_t, 14> message);

/// Compact position reports: latitude and longitude as 17-bit fractions of a zone.
struct CompactPosition {
    bool odd = false;
    std::uint32_t lat = 0, lon = 0;
};
/// Number of longitude zones at a latitude (rad).
[[nodiscard]] int longitude_zones(double lat);
/// Airborne position from an even and an odd report, at the later one's time; nothing where they lie in different zones of latitude.
[[nodiscard]] std::optional<Geodetic> global_position(const CompactPosition& even, const CompactPosition& odd, bool odd_is_later);
/// Position from one report within half a zone (330 km in the air, 83 km on the surface) of a known place.
[[nodiscard]] Geodetic local_position(const CompactPosition& report, const Geodetic& near, bool surface);

}  // namespace schuler::io
