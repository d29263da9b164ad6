// Interpretation of each column of a file, and the reason.
#pragma once

#include <filesystem>
#include <string>

namespace schuler::inspect {

/// How each file was recognised, and each of its columns interpreted, one line each.
/// @throws Error(Input) if the path does not exist or the folder cannot be listed
[[nodiscard]] std::string explain(const std::filesystem::path& path);

}  // namespace schuler::inspect
