// Identification of existing files written by Schuler: it overwrites only these.
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace schuler::io {

/// Each folder that Schuler writes to has a hidden list of the files written, with size and time. An existing file is Schuler's
/// own if it is in that list as it is now. The list also says which files are one result.
inline constexpr const char* own_files_list = ".schuler";

/// True if `file` may be overwritten: it does not exist, is not a regular file (/dev/stdout), or is Schuler's own.
[[nodiscard]] bool may_overwrite(const std::filesystem::path& file);

/// @throws Error(Input) if it may not
void check_overwrite(const std::filesystem::path& file);

/// Adds a file that was just written, or that the user allows to be overwritten, to the list of its folder. Without space or
/// permission the list is not written.
void note_own_file(const std::filesystem::path& file);

/// The same for `file` before it is moved to its place: a process that is killed in between leaves no file that it does not know.
void note_own_file(const std::filesystem::path& final_place, const std::filesystem::path& file);

/// Names of the files of a result of this kind that was written last, or was being written, to `folder`. `last`: name of the file that
/// completes such a result.
[[nodiscard]] std::set<std::string> files_of_result(const std::filesystem::path& folder, const std::string& last);

/// Adds names to it; with `only`, they are all of it.
void note_result(const std::filesystem::path& folder, const std::string& last, const std::set<std::string>& names, bool only);

/// The user's permission: `path`, or each regular file in it if it is a folder, may be overwritten from now on.
void allow_overwrite(const std::filesystem::path& path);

}  // namespace schuler::io
