// One panel as an HTML figure with inline SVG.
#pragma once

#include "schuler/report/detail/axis.h"
#include "schuler/report/report.h"

#include <string>

namespace schuler::report::detail {

/// Position of the plot area in the viewBox of a panel, px, and the displayed intervals (log10 on a logarithmic axis).
struct Frame {
    static constexpr double width = 1100.0, left = 72.0, right = 22.0, bottom = 38.0;
    double top = 8.0;  ///< larger if spans have their labels above the plot
    double height = 200.0;
    Range x, y;

    [[nodiscard]] double plot_width() const { return width - left - right; }
    [[nodiscard]] double plot_height() const { return height - top - bottom; }
    [[nodiscard]] double px(double v) const { return (v - x.lo) / x.width() * plot_width(); }   ///< from the plot's left edge
    [[nodiscard]] double py(double v) const { return (y.hi - v) / y.width() * plot_height(); }  ///< from the plot's upper edge
};

/// Number of points to which a series is decimated.
inline constexpr std::size_t points_per_series = 2000;
/// A map's curves show detail at every zoom level, and there are few of them; for a band, the extremes of both edges are kept.
inline constexpr std::size_t points_per_map_series = 6000;
inline constexpr std::size_t points_per_band = 4000;
/// Path coordinates are integers with this many units per px: fine enough for zooming, short to write.
inline constexpr double path_units_per_px = 100.0;

/// SVG path elements in path units. index relates a curve to its legend entry.
[[nodiscard]] std::string series_path(const Series& series, const Panel& panel, const Frame& frame, int index);
[[nodiscard]] std::string band_path(const Band& band, const Panel& panel, const Frame& frame, int index);

/// The whole figure: caption, legend, plot. number makes ids unique on the page. Throws Error(Input) if lengths differ.
[[nodiscard]] std::string figure(const Panel& panel, int number);

}  // namespace schuler::report::detail
