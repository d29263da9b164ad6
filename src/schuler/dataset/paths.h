// Names of files in a data set's settings as paths.
#pragma once

#include <filesystem>
#include <string>

namespace schuler::dataset {

/// $NAME and ${NAME} replaced by environment variables. @throws Error(Input) for one that is not set.
[[nodiscard]] std::string with_environment(const std::string& path, const std::string& key);

/// A file that the settings name under `key`, from the data set's folder on. @throws Error(Input) as with_environment().
[[nodiscard]] std::filesystem::path resolved(const std::filesystem::path& folder, const std::string& file,
                                             const std::string& key);

}  // namespace schuler::dataset
