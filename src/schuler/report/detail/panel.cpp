#include "schuler/report/detail/panel.h"

#include "schuler/core/error.h"
#include "schuler/report/detail/markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

namespace schuler::report::detail {
namespace {

using Out = std::back_insert_iterator<std::string>;

void check_lengths(const Panel& panel) {
    const auto refuse = [&panel](const std::string& name) {
        throw input_error(fmt::format("report panel '{}': the vectors of '{}' differ in length", panel.title, name));
    };
    for (const Series& s : panel.series) {
        if (s.x.size() != s.y.size() || (!s.time.empty() && s.time.size() != s.x.size())) refuse(s.name);
    }
    for (const Band& b : panel.bands) {
        if (b.x.size() != b.lo.size() || b.x.size() != b.hi.size()) refuse(b.name);
    }
}

// The narrower interval of a map is widened to equal scales; a tall track gives a taller panel.
void equalize(Frame& frame) {
    constexpr double tallest = 620.0;
    const double wanted = frame.y.width() / frame.x.width() * frame.plot_width() + frame.top + Frame::bottom;
    frame.height = std::clamp(wanted, 320.0, tallest);
    const auto widen = [](Range& r, double width) {
        const double centre = 0.5 * (r.lo + r.hi);
        r = {centre - 0.5 * width, centre + 0.5 * width};
    };
    const double per_px = std::max(frame.x.width() / frame.plot_width(), frame.y.width() / frame.plot_height());
    widen(frame.x, per_px * frame.plot_width());
    widen(frame.y, per_px * frame.plot_height());
}

void append_axes(std::string& out, const Panel& panel, const Frame& f) {
    const double w = f.plot_width(), h = f.plot_height();
    fmt::format_to(Out(out), "<rect class=\"box\" x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/><g class=\"ticks\">",
                   Frame::left, f.top, w, h);
    for (const Tick& t : linear_ticks(f.x, 10)) {
        const double x = Frame::left + f.px(t.value);
        fmt::format_to(Out(out),
                       "<path class=\"grid\" d=\"M{:.1f} {:g}v{:g}\"/><text class=\"tx\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x,
                       f.top, h, x, f.top + h + 14.0, t.label);
    }
    // The tick step of a map is the same on both axes.
    const double rows = panel.equal_axes ? 10.0 * h / w : std::max(2.0, std::floor(h / 34.0));
    const bool stepped = panel.y_step > 0.0 && f.y.width() / panel.y_step < 3 * rows;
    for (const Tick& t : panel.log_y ? log_ticks(f.y) : stepped ? ticks_every(f.y, panel.y_step, 0) : linear_ticks(f.y, rows)) {
        if (!panel.row_names.empty()) break;
        const double y = f.top + f.py(t.value);
        const bool zero = !panel.log_y && t.value == 0.0;
        fmt::format_to(Out(out),
                       "<path class=\"grid{}\" d=\"M{:g} {:.1f}h{:g}\"/><text class=\"ty\" x=\"{:g}\" y=\"{:.1f}\">{}</text>",
                       zero ? " zero" : "", Frame::left, y, w, Frame::left - 6.0, y + 4.0, t.label);
    }
    fmt::format_to(Out(out), "</g><text class=\"tx lab\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", Frame::left + 0.5 * w,
                   f.height - 6.0, io::xml_text(panel.x_label));
    const double middle = f.top + 0.5 * h;
    fmt::format_to(Out(out), "<text class=\"tx lab\" transform=\"rotate(-90 13 {:.1f})\" x=\"13\" y=\"{:.1f}\">{}</text>", middle,
                   middle, io::xml_text(panel.y_label));
}

// Approximate width of a text in the small label size, px.
double text_width(std::string_view text) { return 6.2 * static_cast<double>(text.size()); }

void append_spans(std::string& out, const Panel& panel, const Frame& f) {
    double free_from = 0.0;  // labels above the plot, if there is space
    for (const Span& span : panel.spans) {
        if (!std::isfinite(span.start) || !std::isfinite(span.stop)) continue;
        const double a = std::clamp(f.px(span.start), 0.0, f.plot_width()), b = std::clamp(f.px(span.stop), 0.0, f.plot_width());
        if (!(b > a)) continue;
        fmt::format_to(Out(out),
                       "<g class=\"span\" data-a=\"{:.2f}\" data-b=\"{:.2f}\"><title>{}: {:g} to {:g}</title><rect class=\"{}\" "
                       "x=\"{:.2f}\" "
                       "y=\"{:g}\" width=\"{:.2f}\" height=\"{:g}\"/>",
                       f.px(span.start), f.px(span.stop), io::xml_text(span.label), span.start, span.stop,
                       span.hatched ? "hatch" : "shade", Frame::left + a, f.top, b - a, f.plot_height());
        const double width = text_width(span.label);
        const bool room = a >= free_from && a + width < f.plot_width();
        if (room) free_from = a + width + 8.0;
        fmt::format_to(Out(out), "<text class=\"out{}\" x=\"{:.2f}\" y=\"{:g}\">{}</text></g>", room ? "" : " hidden",
                       Frame::left + a, f.top - 5.0, io::xml_text(span.label));
    }
}

// Upper left corner, px from that of the plot, of a box of the given size in the corner of the plot with the fewest points.
std::pair<double, double> free_corner(const Panel& panel, const Frame& f, double width, double height) {
    const double right = f.plot_width() - width - 8.0, bottom = f.plot_height() - height - 4.0;
    std::pair<double, double> best;
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (const auto& corner : {std::pair{right, bottom}, std::pair{8.0, bottom}, std::pair{right, 4.0}, std::pair{8.0, 4.0}}) {
        std::size_t inside = 0;
        for (const Series& s : panel.series) {
            for (std::size_t i = 0; i < s.x.size(); ++i) {
                const double x = f.px(s.x[i]) - corner.first, y = f.py(s.y[i]) - corner.second;
                inside += x > -4.0 && x < width + 4.0 && y > -4.0 && y < height + 4.0 ? 1 : 0;
            }
        }
        if (inside >= fewest) continue;
        fewest = inside;
        best = corner;
    }
    return best;
}

// A scale bar of round length in a corner of a map.
void append_scale_bar(std::string& out, const Panel& panel, const Frame& f) {
    constexpr double height = 32.0, margin = 10.0;
    const double per_px = f.x.width() / f.plot_width();
    const std::vector<Tick> ticks = linear_ticks({0.0, 220.0 * per_px}, 2);
    if (ticks.size() < 2) return;
    const double length = ticks[1].value, px = length / per_px;
    const auto [left, top] = free_corner(panel, f, px + 2.0 * margin, height);
    const double x = Frame::left + left, y = f.top + top;
    const std::string label = length >= 1000.0 ? fmt::format("{:g} km", length / 1000.0) : fmt::format("{:g} m", length);
    fmt::format_to(Out(out),
                   "<g class=\"scale\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:g}\"/>"
                   "<path d=\"M{:.1f} {:.1f}v8m0-4h{:.1f}m0-4v8\"/><text class=\"tx\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text></g>",
                   x, y, px + 2.0 * margin, height, x + margin, y + 19.0, px, x + margin + 0.5 * px, y + 15.0, label);
}

void append_swatch(std::string& out, Ink ink, std::string_view shape) {
    constexpr std::array<std::string_view, 8> names{"blue", "vermillion", "green", "purple", "orange", "sky", "text", "muted"};
    const std::string_view name = names[static_cast<std::size_t>(ink)];
    out += "<svg class=\"sw\" viewBox=\"0 0 22 12\" aria-hidden=\"true\">";
    if (shape == "band") fmt::format_to(Out(out), "<path class=\"bd f-{}\" d=\"M1 1h20v10h-20z\"/>", name);
    else if (shape == "sq")
        fmt::format_to(Out(out), "<path class=\"sq i-{}\" d=\"M11 6h0\"/><path class=\"hole\" d=\"M11 6h0\"/>", name);
    else if (shape == "dot") fmt::format_to(Out(out), "<path class=\"dot i-{}\" d=\"M5 8h0M11 4h0M17 7h0\"/>", name);
    else fmt::format_to(Out(out), "<path class=\"{} i-{}\" stroke-width=\"2\" d=\"M1 6h20\"/>", shape, name);
    out += "</svg>";
}

// Buttons without a function until the script is active: they then show and hide their curve.
void append_legend(std::string& out, const Panel& panel) {
    out += "<div class=\"legend\">";
    int index = 0;
    const auto entry = [&](const std::string& name, Ink ink, std::string_view shape) {
        if (!name.empty()) {
            fmt::format_to(Out(out), "<button type=\"button\" data-i=\"{}\" aria-pressed=\"true\">", index);
            append_swatch(out, ink, shape);
            fmt::format_to(Out(out), "{}</button>", io::xml_text(name));
        }
        ++index;
    };
    for (const Band& b : panel.bands) entry(b.name, b.ink, "band");
    for (const Series& s : panel.series) {
        constexpr std::array<std::string_view, 4> shapes{"ln", "ln dash", "dot", "sq"};
        entry(s.name, s.ink, shapes[static_cast<std::size_t>(s.mark)]);
    }
    out += "</div>";
}

std::string description(const Panel& panel, const DataRange& range) {
    if (range.x.empty()) return fmt::format("{}: no data.", panel.title);
    const double lo = panel.log_y ? std::pow(10.0, range.y.lo) : range.y.lo,
                 hi = panel.log_y ? std::pow(10.0, range.y.hi) : range.y.hi;
    std::string text = fmt::format("{} from {} to {} ({}), against {} from {} to {}.", panel.title, number(lo, 3), number(hi, 3),
                                   panel.y_label, panel.x_label, number(range.x.lo, 6), number(range.x.hi, 6));
    std::string names;
    for (const Band& b : panel.bands) names += b.name.empty() ? "" : (names.empty() ? "" : "; ") + b.name;
    for (const Series& s : panel.series) names += s.name.empty() ? "" : (names.empty() ? "" : "; ") + s.name;
    return names.empty() ? text : text + " Shown: " + names + ".";
}

void append_curves(std::string& out, const Panel& panel, const Frame& f, int number) {
    fmt::format_to(Out(out), "<clipPath id=\"c{}\"><rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/></clipPath>",
                   number, Frame::left, f.top, f.plot_width(), f.plot_height());
    fmt::format_to(Out(out), "<g clip-path=\"url(#c{})\"><g class=\"curves\" transform=\"translate({:g} {:g}) scale({:g})\">",
                   number, Frame::left, f.top, 1.0 / path_units_per_px);
    int index = 0;
    for (const Band& b : panel.bands) out += band_path(b, panel, f, index++);
    for (const Series& s : panel.series) out += series_path(s, panel, f, index++);
    out += "</g></g>";
}

}  // namespace

std::string figure(const Panel& panel, int number) {
    check_lengths(panel);
    const DataRange range = data_range(panel);
    const bool empty = range.x.empty();
    Frame f{.top = panel.spans.empty() ? 8.0 : 19.0,
            .height = static_cast<double>(std::clamp(panel.height, 120, 1200)),
            .x = range.x,
            .y = range.y};
    if (empty) f.height = 120.0;
    else if (panel.equal_axes) equalize(f);

    std::string out = fmt::format("<figure class=\"panel{}\"><figcaption><h4>{}</h4>", panel.equal_axes ? " map" : "",
                                  io::xml_text(panel.title));
    if (!empty) append_legend(out, panel);
    fmt::format_to(Out(out),
                   "</figcaption><div class=\"plot\"><svg viewBox=\"0 0 {:g} {:.0f}\" role=\"img\" aria-labelledby=\"t{} d{}\"",
                   Frame::width, std::ceil(f.height), number, number);
    if (!empty) {
        fmt::format_to(
            Out(out), " data-x=\"{:.17g} {:.17g}\" data-y=\"{:.17g} {:.17g}\" data-box=\"{:g} {:g} {:g} {:.6g}\"{}{}{}{}", f.x.lo,
            f.x.hi, f.y.lo, f.y.hi, Frame::left, f.top, f.plot_width(), f.plot_height(),
            panel.time_axis && !panel.equal_axes ? " data-time=\"1\"" : "", panel.equal_axes ? " data-equal=\"1\"" : "",
            panel.log_y ? " data-log=\"1\"" : "", panel.y_limits ? " data-fixed=\"1\"" : "");
        fmt::format_to(Out(out), " data-xl=\"{}\" data-yl=\"{}\"", io::xml_text(panel.x_label), io::xml_text(panel.y_label));
    }
    fmt::format_to(Out(out), "><title id=\"t{}\">{}</title><desc id=\"d{}\">{}</desc>", number, io::xml_text(panel.title), number,
                   io::xml_text(description(panel, range)));
    if (empty) {
        fmt::format_to(Out(out),
                       "<rect class=\"box\" x=\"{:g}\" y=\"8\" width=\"{:g}\" height=\"104\"/><text class=\"tx lab\" x=\"{:g}\" "
                       "y=\"64\">no data</text>",
                       Frame::left, f.plot_width(), Frame::left + 0.5 * f.plot_width());
    } else {
        append_axes(out, panel, f);
        append_spans(out, panel, f);
        append_curves(out, panel, f, number);
        for (const auto& [y, text] : panel.row_names)
            fmt::format_to(Out(out), "<text class=\"lab\" x=\"{:g}\" y=\"{:.1f}\">{}</text>", Frame::left + 6.0,
                           f.top + f.py(y) - 9.0, io::xml_text(text));
        if (panel.equal_axes && panel.x_label.ends_with(", m")) append_scale_bar(out, panel, f);
    }
    return out + "</svg></div></figure>";
}

}  // namespace schuler::report::detail
