#include "schuler/io/text/xml_text.h"

#include <algorithm>
#include <cstdint>

namespace schuler::io {
namespace {

// Length of a UTF-8 sequence at the start of text permitted by XML 1.0, or 0.
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
    const std::uint8_t head = byte(0);
    if (head < 0x80) return head >= 0x20 ? (head != 0x7f ? 1 : 0) : (head == '\t' || head == '\n' || head == '\r' ? 1 : 0);
    const std::size_t length = head >= 0xf0 ? 4 : head >= 0xe0 ? 3 : 2;
    if (head < 0xc2 || head > 0xf4 || text.size() < length) return 0;
    std::uint32_t code = head & (0xffU >> (length + 1));
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return 0;
        code = (code << 6) | (byte(i) & 0x3fU);
    }
    const std::uint32_t smallest = length == 2 ? 0x80 : length == 3 ? 0x800 : 0x10000;
    const bool surrogate = code >= 0xd800 && code <= 0xdfff;
    if (code < smallest || code > 0x10ffff || surrogate || code == 0xfffe || code == 0xffff) return 0;
    return code < 0xa0 ? 0 : length;  // C1 controls
}

}  // namespace

std::string xml_text(std::string_view text) {
    std::string out;
    out.reserve(text.size() + text.size() / 8);
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        switch (length == 0 ? '\0' : text.front()) {
            case '\0': out += "\xef\xbf\xbd"; break;
            case '&': out += "&amp;"; break;
            case '<': out += "&lt;"; break;
            case '>': out += "&gt;"; break;
            case '"': out += "&quot;"; break;
            case '\'': out += "&#39;"; break;
            case '\r': break;  // part of a line end of another system
            default: out += text.substr(0, length);
        }
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return out;
}

}  // namespace schuler::io
