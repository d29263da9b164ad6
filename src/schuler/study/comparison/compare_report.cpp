#include "schuler/math/quantile.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/study/comparison/compare.h"
#include "schuler/study/comparison/compare_windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

using report::Panel;

/// The windows shaded, outages hatched.
std::vector<report::Span> marks_of(const Comparison& c) {
    std::vector<report::Span> out;
    for (const settings::CompareWindow& w : c.windows) out.push_back({w.start, w.end, w.name, false});
    for (const settings::OutageSpan& o : c.outages) out.push_back({o.start, o.start + o.duration, "outage", true});
    std::ranges::stable_sort(out, {}, &report::Span::start);  // labels are placed in this order, windows first
    return out;
}

/// Limits of a logarithmic axis for error norms. A vertical error passes through zero, where its logarithm is unbounded: the axis
/// starts at the decade that excludes at most a hundredth of the values.
std::optional<std::pair<double, double>> decades(const std::vector<report::Series>& series) {
    std::vector<double> values;
    for (const report::Series& s : series)
        for (const double y : s.y)
            if (y > 0.0) values.push_back(y);  // NaN is not
    if (values.empty()) return std::nullopt;
    std::ranges::sort(values);
    const double low = math::quantile_of_sorted(values, 0.01);
    return std::pair{std::pow(10.0, std::floor(std::log10(low))), 1.5 * values.back()};
}

/// The errors of all schemes over time, for the runs with this number of satellites.
Panel error_panel(const Comparison& c, std::optional<std::size_t> satellites, const char* title,
                  std::vector<double> ErrorCourse::*error) {
    constexpr std::array inks{report::Ink::Blue,   report::Ink::Vermillion, report::Ink::Green, report::Ink::Purple,
                              report::Ink::Orange, report::Ink::Sky,        report::Ink::Text};
    Panel panel{title, "time, s", "m"};
    panel.log_y = true;
    panel.height = 320;
    panel.x_limits = {0.0, c.duration};
    for (const ComparedRun& run : c.runs) {
        if (run.satellites != satellites) continue;
        const std::size_t k = panel.series.size();
        panel.series.push_back({run.scheme->title, run.course.t, run.course.*error, inks[k % inks.size()],
                                k < inks.size() ? report::Mark::Line : report::Mark::Dashed});
    }
    if (error == &ErrorCourse::horizontal && !c.windows.empty())
        panel.series.push_back({fmt::format("limit {:g} m", c.rules.limit),
                                {0.0, c.duration},
                                {c.rules.limit, c.rules.limit},
                                report::Ink::Muted,
                                report::Mark::Dashed,
                                1.0});
    panel.y_limits = decades(panel.series);
    return panel;
}

}  // namespace

report::ReportInput comparison_report(const Comparison& c) {
    report::ReportInput page{c.name, {}};
    page.version = c.version;
    page.warnings = c.warnings;
    page.settings = c.settings;
    const std::vector<report::Span> marks = marks_of(c);

    report::Section schemes{
        "Schemes",
        "NEES of the position over its three degrees of freedom (1: consistent); outage: at the end of the first one."};
    report::TableBlock settled = report::table_block(scheme_table(c, false));
    settled.title = "After settling, root mean squares";
    schemes.groups.push_back({"", {}, {std::move(settled)}});
    report::Section windows{"Windows", window_note(c) + "."};
    report::Group& tables = windows.groups.emplace_back();
    for (std::size_t k = 0; k < c.windows.size(); ++k) tables.tables.push_back(report::table_block(window_table(c, k)));

    report::Section errors{"Errors over time", "Where a scheme has no solution its line has a gap."};
    const std::vector<std::optional<std::size_t>> counts = counts_of_satellites(c.runs);
    for (const std::optional<std::size_t>& satellites : counts) {
        report::Group& group = errors.groups.emplace_back();
        if (satellites) group.title = fmt::format("{} satellites", *satellites);
        group.panels = {error_panel(c, satellites, "horizontal error", &ErrorCourse::horizontal),
                        error_panel(c, satellites, "vertical error, absolute", &ErrorCourse::vertical)};
        for (Panel& panel : group.panels) panel.spans = marks;
    }
    const std::size_t in_each = c.runs.size() / counts.size();
    page.subtitle = fmt::format("{} coupling schemes on one flight of {:g} s, seed {}", in_each, c.duration, c.seed);

    page.sections.push_back(std::move(schemes));
    if (!c.windows.empty()) page.sections.push_back(std::move(windows));
    page.sections.push_back(std::move(errors));
    if (!c.plots.empty()) {
        report::Section further{"Signals", {}};
        report::Group& group = further.groups.emplace_back();
        group.panels = c.plots;
        for (Panel& panel : group.panels)
            if (panel.time_axis) panel.spans.insert(panel.spans.end(), marks.begin(), marks.end());
        page.sections.push_back(std::move(further));
    }
    return page;
}

}  // namespace schuler::study
