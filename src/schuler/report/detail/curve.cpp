// Conversion of series and bands to SVG paths.
#include "schuler/report/decimate.h"
#include "schuler/report/detail/markup.h"
#include "schuler/report/detail/panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>

namespace schuler::report::detail {
namespace {

constexpr std::string_view ink_class(Ink ink) {
    constexpr std::array<std::string_view, 8> names{"blue", "vermillion", "green", "purple", "orange", "sky", "text", "muted"};
    return names[static_cast<std::size_t>(ink)];
}

struct Point {
    long x, y;
};

// Path units of a pair already in axis units (log10 if applicable). Points far outside remain outside, but limited.
Point path_point(double x, double y, const Frame& frame) {
    const auto unit = [](double px) { return std::lround(std::clamp(px, -1e5, 1e5) * path_units_per_px); };
    return {unit(frame.px(x)), unit(frame.py(y))};
}

// Relative line-to commands share one letter, and a minus sign is also a separator.
void append_step(std::string& d, Point from, Point to, bool first) {
    const long dx = to.x - from.x, dy = to.y - from.y;
    d += first ? "l" : dx < 0 ? "" : " ";
    fmt::format_to(std::back_inserter(d), "{}{}{}", dx, dy < 0 ? "" : " ", dy);
}

void append_run(std::string& d, const std::vector<Point>& run) {
    if (run.empty()) return;
    fmt::format_to(std::back_inserter(d), "M{} {}", run.front().x, run.front().y);
    for (std::size_t i = 1; i < run.size(); ++i) append_step(d, run[i - 1], run[i], i == 1);
    if (run.size() == 1) d += "h0";  // a single point is drawn as a dot by its round cap
}

// Clamped points stay this far inside, px, so that their mark is complete (the script uses the same number).
constexpr double edge_inset = 5.0;

// Vertical values as drawn: logarithm, clamping. Values that cannot be drawn become NaN.
std::vector<double> drawn_values(const std::vector<double>& y, const Panel& panel, const Frame& frame, bool clamp) {
    std::vector<double> out(y);
    const double inset = edge_inset / frame.plot_height() * frame.y.width();
    for (double& v : out) {
        if (panel.log_y && v == v) v = v > 0.0 ? std::log10(v) : clamp ? frame.y.lo : std::nan("");
        if (clamp) v = std::clamp(v, frame.y.lo + inset, frame.y.hi - inset);
    }
    return out;
}

// Gaps are entries of the source that are not finite; between two kept points there may be decimated points or a gap.
class GapFinder {
public:
    GapFinder(std::span<const double> x, std::span<const double> y) : before_(x.size() + 1, 0) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            before_[i + 1] = before_[i] + (std::isfinite(x[i]) && std::isfinite(y[i]) ? 0 : 1);
        }
    }
    [[nodiscard]] bool between(std::size_t i, std::size_t j) const { return before_[j] != before_[i]; }

private:
    std::vector<std::size_t> before_;
};

// Times of the kept points in milliseconds from the first, as differences: links a map's cursor to the time panels.
std::string time_attribute(const Series& series, const std::vector<std::size_t>& kept) {
    if (series.time.size() != series.x.size() || kept.empty()) return {};
    std::string text = fmt::format(" data-t=\"{:.3f}", series.time[kept.front()]);
    long previous = 0;
    for (std::size_t k = 1; k < kept.size(); ++k) {
        const double ms = (series.time[kept[k]] - series.time[kept.front()]) * 1e3;
        const long now = std::isfinite(ms) && std::abs(ms) < 1e15 ? std::lround(ms) : previous;
        fmt::format_to(std::back_inserter(text), " {}", now - previous);
        previous = now;
    }
    return text + "\"";
}

}  // namespace

std::string series_path(const Series& series, const Panel& panel, const Frame& frame, int index) {
    const std::vector<double> y = drawn_values(series.y, panel, frame, series.clamp);
    const std::array<std::span<const double>, 2> channels{series.x, y};
    const std::vector<std::size_t> kept = decimate(channels, panel.equal_axes ? points_per_map_series : points_per_series);
    const bool line = series.mark == Mark::Line || series.mark == Mark::Dashed;
    const GapFinder gaps(series.x, y);

    std::string d;
    std::vector<Point> run;
    for (std::size_t k = 0; k < kept.size(); ++k) {
        if (!line || (k > 0 && gaps.between(kept[k - 1], kept[k]))) {
            append_run(d, run);
            run.clear();
        }
        run.push_back(path_point(series.x[kept[k]], y[kept[k]], frame));
    }
    append_run(d, run);

    const std::string_view kind = line ? "line" : "dots";
    const std::string common = fmt::format("data-i=\"{}\" data-k=\"{}\" data-n=\"{}\"{}", index, kind, io::xml_text(series.name),
                                           series.clamp ? " data-clamp=\"1\"" : "");
    const std::string_view ink = ink_class(series.ink);
    if (series.mark == Mark::Squares) {  // a square with a hole: two passes, the second is not a separate curve
        return fmt::format("<path class=\"sq i-{}\" {}{} d=\"{}\"/><path class=\"hole\" data-i=\"{}\" d=\"{}\"/>", ink, common,
                           time_attribute(series, kept), d, index, d);
    }
    const std::string style = line ? fmt::format(" stroke-width=\"{:g}\"", series.width) : "";
    const std::string_view shape = series.mark == Mark::Dots ? "dot" : series.mark == Mark::Dashed ? "ln dash" : "ln";
    return fmt::format("<path class=\"{} i-{}\"{} {}{} d=\"{}\"/>", shape, ink, style, common, time_attribute(series, kept), d);
}

std::string band_path(const Band& band, const Panel& panel, const Frame& frame, int index) {
    const std::vector<double> lo = drawn_values(band.lo, panel, frame, false);
    const std::vector<double> hi = drawn_values(band.hi, panel, frame, false);
    const std::array<std::span<const double>, 3> channels{band.x, lo, hi};
    const std::vector<std::size_t> kept = decimate(channels, points_per_band);
    const GapFinder gaps_lo(band.x, lo), gaps_hi(band.x, hi);

    std::string d;
    std::vector<Point> upper, outline;
    const auto close_run = [&](std::size_t first, std::size_t last) {  // kept[first, last): along hi, back along lo
        outline = upper;
        for (std::size_t k = last; k > first; --k) outline.push_back(path_point(band.x[kept[k - 1]], lo[kept[k - 1]], frame));
        append_run(d, outline);
        if (!outline.empty()) d += "z";
        upper.clear();
    };
    std::size_t first = 0;
    for (std::size_t k = 0; k < kept.size(); ++k) {
        if (k > 0 && (gaps_lo.between(kept[k - 1], kept[k]) || gaps_hi.between(kept[k - 1], kept[k]))) {
            close_run(first, k);
            first = k;
        }
        upper.push_back(path_point(band.x[kept[k]], hi[kept[k]], frame));
    }
    close_run(first, kept.size());
    return fmt::format("<path class=\"bd f-{}\" data-i=\"{}\" data-k=\"band\" data-n=\"{}\" d=\"{}\"/>", ink_class(band.ink),
                       index, io::xml_text(band.name), d);
}

}  // namespace schuler::report::detail
