// Files that may be read: neither pipes nor devices, which could block a reader indefinitely.
#pragma once

#include <filesystem>

namespace schuler::io {

/// @throws Error(Input) if `path` does not exist, is not accessible, or is not a regular file on a disk (a folder, pipe, socket,
/// device, or a virtual file as in /proc)
void check_regular_file(const std::filesystem::path& path);

/// True if it would be accepted.
[[nodiscard]] bool is_regular_file(const std::filesystem::path& path);

}  // namespace schuler::io
