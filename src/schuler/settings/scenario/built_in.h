// Scenarios of the folder examples that are compiled into the program, so that it runs them without its sources.
#pragma once

#include <string_view>

namespace schuler::settings::detail {

/// Text of a compiled-in file by its name, "demo.toml".
/// @throws Error(Input) if there is none of that name.
[[nodiscard]] std::string_view embedded_file(std::string_view name);

}  // namespace schuler::settings::detail
