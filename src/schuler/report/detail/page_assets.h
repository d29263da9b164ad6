// Style sheet and script of the page, as text without the surrounding elements.
#pragma once

#include <string_view>

namespace schuler::report::detail {

/// Light and dark by the reader's preference, always light on paper. Contains neither < nor &.
[[nodiscard]] std::string_view page_style();
/// Cursors, zoom and hiding of series on top of a page that is complete without; needs no library. Contains no "]]>".
[[nodiscard]] std::string_view page_script();

}  // namespace schuler::report::detail
