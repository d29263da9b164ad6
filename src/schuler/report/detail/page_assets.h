// Style sheet and script of the page (src/schuler/report/page), compiled in as they are.
#pragma once

#include <string_view>

namespace schuler::report::detail {

/// page.css: light and dark by the reader's preference, always light on paper; contains neither < nor &. page.js: cursors, zoom and
/// hiding of series on top of a page that is complete without; needs no library, contains no "]]>". It reads the curves' numbers back
/// from the path data (hundredths of a px), so that nothing is in the file twice; a view is [x0, x1, y0, y1] in axis units, log10 on a
/// logarithmic axis, and zooming is a transform of the curves and new ticks.
[[nodiscard]] std::string_view embedded_file(std::string_view name);

}  // namespace schuler::report::detail
