// Text inside XML and HTML.
#pragma once

#include <string>
#include <string_view>

namespace schuler::io {

/// Text for element content and quoted attributes: & < > " ' become references; carriage returns are dropped, other control
/// characters (except tab and newline), bytes that are not UTF-8 and code points forbidden in XML become U+FFFD.
[[nodiscard]] std::string xml_text(std::string_view text);

}  // namespace schuler::io
