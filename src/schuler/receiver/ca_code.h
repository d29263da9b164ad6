// The coarse acquisition codes of GPS.
#pragma once

#include <array>
#include <cstdint>

namespace schuler::receiver {

/// Chips of one period, first to last; +1 for a logical 0, -1 for a 1.
using CaCode = std::array<std::int8_t, 1023>;

/// [ISGPS200:3.3.2.3], PRN 1 to 32; throws Error(Input) otherwise.
[[nodiscard]] CaCode ca_code(int prn);

}  // namespace schuler::receiver
