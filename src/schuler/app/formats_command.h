// `schuler help formats` and `schuler inspect --explain`.
#pragma once

#include <filesystem>
#include <string>

namespace schuler::app {

/// The formats that are read and written.
[[nodiscard]] std::string formats_help();

/// What each column of the files was taken for. @throws Error(Input) where the path does not exist
[[nodiscard]] std::string explained(const std::filesystem::path& path);

}  // namespace schuler::app
