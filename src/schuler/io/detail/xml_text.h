// Text inside XML: GPX and KML.
#pragma once

#include <string>
#include <string_view>

namespace schuler::io::detail {

/// Without control characters, which XML cannot hold.
[[nodiscard]] inline std::string xml_text(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else if (static_cast<unsigned char>(c) >= 0x20) out += c;
    }
    return out;
}

}  // namespace schuler::io::detail
