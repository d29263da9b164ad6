// TOML text to values; the only part that depends on the TOML library.
#pragma once

#include "schuler/settings/value.h"

#include <filesystem>
#include <string_view>

namespace schuler::settings {

/// The root table of a TOML file, each value with its line.
/// @throws Error(Input) if the file cannot be read (a directory, missing, larger than 16 MB) or is not TOML (file and line).
[[nodiscard]] ValueTable read_toml(const std::filesystem::path& file);

/// The same for a text; `origin` is used in messages.
[[nodiscard]] ValueTable parse_toml(std::string_view text, const std::string& origin);

/// The value of "key=value" on a command line: TOML if it parses as a value (30, true, [1, 2], "x"), otherwise plain text.
[[nodiscard]] Value parse_toml_value(std::string_view text);

}  // namespace schuler::settings
