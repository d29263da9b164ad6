// Hatanaka-compressed observation files, by means of the program crx2rnx if installed.
#pragma once

#include <string>
#include <string_view>

namespace schuler::io {

/// True if the text begins like a Hatanaka-compressed file.
[[nodiscard]] bool is_compact_rinex(std::string_view text);

/// The RINEX text of a Hatanaka-compressed one: runs `crx2rnx -` (or CRX2RNX) from the PATH. `name` is used in messages.
/// @throws Error(Input): the program is not installed, or it fails.
[[nodiscard]] std::string decompact_rinex(std::string_view text, const std::string& name);

}  // namespace schuler::io
