// track.kml: the track for a map viewer.
#pragma once

#include "schuler/core/nav_state.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace schuler::io {

/// Keyhole Markup Language 2.2: one line of at most `largest` points (evenly decimated; first and last are kept), and marks at
/// start and stop with their times (s). Heights are written unchanged and drawn clamped to the ground.
[[nodiscard]] std::string track_kml(std::span<const SolutionRow> rows, const std::string& name, std::size_t largest = 20'000);

/// Writes it atomically. Throws Error as AtomicFile does.
void write_track_kml(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string& name,
                     std::size_t largest = 20'000);

}  // namespace schuler::io
