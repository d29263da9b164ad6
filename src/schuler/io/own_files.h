// Which existing files are Schuler's own: it overwrites what it has written itself, and nothing else.
#pragma once

#include <filesystem>

namespace schuler::io {

/// Each folder that Schuler writes into has a hidden list of the files written, with size and time. An existing file is Schuler's own while it is
/// in that list and has not been changed since.
inline constexpr const char* own_files_list = ".schuler";

/// Whether `file` may be overwritten: it does not exist, is no regular file (/dev/stdout), or is Schuler's own.
[[nodiscard]] bool may_overwrite(const std::filesystem::path& file);

/// @throws Error(Input) where it may not
void check_overwrite(const std::filesystem::path& file);

/// Puts a file that has just been written, or that the user allows to be overwritten, on the list of its folder. A folder without room or
/// permission for the list goes without.
void note_own_file(const std::filesystem::path& file);

/// The user's consent: `path`, or each regular file in it where it is a folder, may be overwritten from now on.
void allow_overwrite(const std::filesystem::path& path);

}  // namespace schuler::io
