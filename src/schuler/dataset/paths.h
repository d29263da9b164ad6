// Conversion of file names in a data set's settings to paths.
#pragma once

#include <filesystem>
#include <string>

namespace schuler::dataset {

/// Replaces $NAME and ${NAME} by environment variables. @throws Error(Input) for one that is not set.
[[nodiscard]] std::string with_environment(const std::string& path, const std::string& key);

/// A file named by the setting `key`, relative to the data set's folder. @throws Error(Input) as with_environment().
[[nodiscard]] std::filesystem::path resolved(const std::filesystem::path& folder, const std::string& file,
                                             const std::string& key);

}  // namespace schuler::dataset
