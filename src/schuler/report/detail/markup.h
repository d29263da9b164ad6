// Text into HTML.
#pragma once

#include <string>
#include <string_view>

namespace schuler::report::detail {

/// Text for element content and quoted attributes: & < > " ' become references; carriage returns are dropped, other control
/// characters (but tab and newline), bytes that are not UTF-8 and code points that XML forbids become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// An identifier of a-z, 0-9 and hyphens made from a title; number keeps it unique.
[[nodiscard]] std::string anchor(std::string_view title, int number);

}  // namespace schuler::report::detail
