// Files that may be read: neither pipes nor devices, at which a reader would wait for ever.
#pragma once

#include <filesystem>

namespace schuler::io {

/// @throws Error(Input) where `path` does not exist, cannot be looked at, or is no regular file on a disk (a folder, pipe, socket, device, or a
/// window into the system as in /proc)
void check_regular_file(const std::filesystem::path& path);

/// Whether it would be accepted.
[[nodiscard]] bool is_regular_file(const std::filesystem::path& path);

}  // namespace schuler::io
