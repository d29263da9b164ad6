// What each column of a file was taken for, and why.
#pragma once

#include <filesystem>
#include <string>

namespace schuler::inspect {

/// How each file was recognised, and what each of its columns was taken for, a line each.
/// @throws Error(Input) where the path does not exist or the folder cannot be listed
[[nodiscard]] std::string explain(const std::filesystem::path& path);

}  // namespace schuler::inspect
