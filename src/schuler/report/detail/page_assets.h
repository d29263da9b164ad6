// Style sheet and script of the page (src/schuler/report/page), compiled in unchanged.
#pragma once

#include <string_view>

namespace schuler::report::detail {

/// page.css: light and dark according to the reader's preference, always light on paper; contains neither < nor &. page.js:
/// cursors, zoom and hiding of series for a page that is complete without it; requires no library, contains no "]]>". It reads
/// the numbers of the curves from the path data (hundredths of a px), so that nothing is stored twice; a view is [x0, x1, y0, y1]
/// in axis units, log10 on a logarithmic axis, and zooming is a transform of the curves with new ticks.
[[nodiscard]] std::string_view embedded_file(std::string_view name);

}  // namespace schuler::report::detail
