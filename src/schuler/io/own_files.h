// Identification of existing files written by Schuler: it overwrites only these.
#pragma once

#include <filesystem>

namespace schuler::io {

/// Each folder that Schuler writes to has a hidden list of the files written, with size and time. An existing file is Schuler's
/// own if it is in that list and has not been changed since.
inline constexpr const char* own_files_list = ".schuler";

/// True if `file` may be overwritten: it does not exist, is not a regular file (/dev/stdout), or is Schuler's own.
[[nodiscard]] bool may_overwrite(const std::filesystem::path& file);

/// @throws Error(Input) if it may not
void check_overwrite(const std::filesystem::path& file);

/// Adds a file that was just written, or that the user allows to be overwritten, to the list of its folder. Without space or
/// permission the list is not written.
void note_own_file(const std::filesystem::path& file);

/// The user's permission: `path`, or each regular file in it if it is a folder, may be overwritten from now on.
void allow_overwrite(const std::filesystem::path& path);

}  // namespace schuler::io
