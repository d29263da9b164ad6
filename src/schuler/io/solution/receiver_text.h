// Solutions in the output formats of receivers and RTKLIB.
#pragma once

#include "schuler/core/nav_state.h"

#include <filesystem>
#include <span>
#include <string>

namespace schuler::io {

/// RTKLIB .pos: week and seconds of GPS time to the nanosecond, degrees to 1e-10, heights to 0.1 mm, Q = 5; absent sigmas are zero.
void write_rtklib_pos(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string& title);

/// NMEA 0183: GGA, RMC (VTG without a date), GST, HDT; UTC to the millisecond, heights ellipsoidal with an undulation of zero.
void write_nmea(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string& title);

}  // namespace schuler::io
