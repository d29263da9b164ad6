// Text inside XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace schuler::io {

/// Text for element content and quoted attributes: & < > " ' become references; carriage returns are dropped, other control
/// characters (but tab and newline), bytes that are not UTF-8 and code points that XML forbids become U+FFFD.
[[nodiscard]] std::string xml_text(std::string_view text);

}  // namespace schuler::io
