// Text of unknown origin for a terminal.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace schuler::cli {

/// The text with control characters (of C0 except line ends and tabs, DEL, and of C1 in UTF-8) written as \xNN: a file name or a
/// log field must not move the cursor, change colours or set the title of the window.
[[nodiscard]] inline std::string printable(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0u;
        if (c == 0xc2 && next >= 0x80 && next < 0xa0) {
            out += fmt::format("\\x{:02x}", next);
            ++i;
        } else if ((c < 0x20 && c != '\n' && c != '\t') || c == 0x7f) {
            out += fmt::format("\\x{:02x}", c);
        } else {
            out += text[i];
        }
    }
    return out;
}

}  // namespace schuler::cli
