// Conversion of text to a CSV field.
#pragma once

#include <string>
#include <string_view>

namespace schuler::io {

/// In quotation marks if it would otherwise not be a single field.
[[nodiscard]] inline std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

}  // namespace schuler::io
