// `schuler help formats` and `schuler inspect --explain`.
#pragma once

#include <filesystem>
#include <string>

namespace schuler::app {

/// The formats that can be read and written.
[[nodiscard]] std::string formats_help();

/// The interpretation of each column of the files. @throws Error(Input) if the path does not exist
[[nodiscard]] std::string explained(const std::filesystem::path& path);

}  // namespace schuler::app
