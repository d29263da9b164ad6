// External names used as file names: their syntax, and checks that they stay inside their folder.
#pragma once

#include "schuler/settings/value.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace schuler::serve {

/// A single name in a folder: UTF-8 without separators, control characters and a leading dot, 1 to 120 bytes.
[[nodiscard]] bool is_file_name(std::string_view name);

/// Lower-case letters, digits and dashes from any text: the folder of a run or a data set. "run" if none remain.
[[nodiscard]] std::string folder_name(std::string_view title);

/// folder / name, if that is a valid name and no link leads out of the folder. @throws Refusal 400 or 404
[[nodiscard]] std::filesystem::path inside(const std::filesystem::path& folder, const std::string& name);

/// External settings may name only files beside them: no absolute path, no "..", no "$NAME", no parent folder.
/// @throws Refusal 422 with the key
void check_file_settings(const settings::SettingList& settings);

/// The same for a project file of another program, line by line.
void check_project_text(std::string_view text, const std::string& file);

}  // namespace schuler::serve
