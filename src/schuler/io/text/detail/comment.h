// Lines of a table that are comments. Private to the readers.
#pragma once

#include <string_view>

namespace schuler::io::detail {

/// The line without the blanks before it. Spreadsheets quote a comment like any other text.
[[nodiscard]] inline bool is_comment(std::string_view line) {
    if (line.starts_with("//")) return true;
    if (line.starts_with('"') || line.starts_with('\'')) line.remove_prefix(1);
    return line.starts_with('#') || line.starts_with('%');
}

}  // namespace schuler::io::detail
