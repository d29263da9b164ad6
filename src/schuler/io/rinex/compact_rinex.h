// Hatanaka-compressed observation files, through the program crx2rnx where it is installed.
#pragma once

#include <string>
#include <string_view>

namespace schuler::io {

/// Whether the text begins as a Hatanaka-compressed file does.
[[nodiscard]] bool is_compact_rinex(std::string_view text);

/// The RINEX text of a Hatanaka-compressed one: runs `crx2rnx -` (or CRX2RNX) from the PATH. `name` is for messages.
/// @throws Error(Input): the program is not installed, or it fails.
[[nodiscard]] std::string decompact_rinex(std::string_view text, const std::string& name);

}  // namespace schuler::io
