// Track, motion and outages of a run.
#include "schuler/core/units.h"
#include "schuler/report/detail/run_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::report::detail {
namespace {

std::string solution_name(const RunReportData& data) { return data.smoothed ? "solution, smoothed" : "solution"; }

std::string reference_name(const RunReportData& data) { return data.reference_name.empty() ? "reference" : data.reference_name; }

bool in_outage(const RunReportData& data, double t) {
    return std::any_of(data.outages.begin(), data.outages.end(),
                       [t](const OutageEntry& o) { return t >= o.start_s && t <= o.start_s + o.duration_s; });
}

// Rows (SolutionRow, GnssFix, ReferenceSample) as a curve on the map: x east, y north.
template <typename Rows>
Series map_series(const RunReportData& data, const Rows& rows, Series style) {
    for (const auto& row : rows) {
        const Ned ned = data.local(row.position);
        style.x.push_back(ned.r.y());
        style.y.push_back(ned.r.x());
        style.time.push_back(axis_seconds(data, row.time));
    }
    break_at_gaps(style);
    return style;
}

Series solution_in_outages(const RunReportData& data, const Series& solution) {
    Series out{.name = "solution in outages",
               .x = solution.x,
               .y = solution.y,
               .ink = Ink::Vermillion,
               .mark = Mark::Line,
               .width = 3.5};
    for (std::size_t i = 0; i < out.y.size(); ++i) {
        if (!in_outage(data, solution.time[i])) out.y[i] = not_given;
    }
    return out;
}

Panel map_panel(const RunReportData& data) {
    Panel panel{.title = "Track", .x_label = "east, m", .y_label = "north, m", .time_axis = false, .equal_axes = true};
    if (!data.reference.empty()) {
        panel.series.push_back(
            map_series(data, data.reference, {.name = reference_name(data), .x = {}, .y = {}, .ink = Ink::Green, .width = 4.5}));
    }
    if (!data.gnss.empty()) {
        panel.series.push_back(
            map_series(data, data.gnss, {.name = "GNSS", .x = {}, .y = {}, .ink = Ink::Orange, .mark = Mark::Dots}));
    }
    const Series solution = map_series(data, data.solution, {.name = solution_name(data), .x = {}, .y = {}, .width = 2.2});
    panel.series.push_back(solution);
    if (!data.outages.empty()) panel.series.push_back(solution_in_outages(data, solution));
    panel.series.push_back(
        {.name = "start", .x = {solution.x.front()}, .y = {solution.y.front()}, .ink = Ink::Text, .mark = Mark::Squares});
    return panel;
}

TableBlock run_table(const RunReportData& data) {
    double distance = 0.0, fastest = 0.0, lowest = not_given, highest = not_given;
    for (std::size_t i = 0; i < data.solution.size(); ++i) {
        const SolutionRow& row = data.solution[i];
        fastest = std::fmax(fastest, row.v_eb_n.norm());
        lowest = std::fmin(lowest, row.position.h);
        highest = std::fmax(highest, row.position.h);
        if (i == 0) continue;
        const double dt = (row.time - data.solution[i - 1].time).seconds();
        const double step = 0.5 * dt * (row.v_eb_n + data.solution[i - 1].v_eb_n).norm();
        if (std::isfinite(step)) distance += step;
    }
    const SolutionRow &first = data.solution.front(), &last = data.solution.back();
    TableBlock table{"Run", {"", "value", "unit"}, {}};
    table.rows = {{"begins", fmt::format("{:.1f}", axis_seconds(data, first.time)), "s"},
                  {"ends", fmt::format("{:.1f}", axis_seconds(data, last.time)), "s"},
                  {"distance travelled", fmt::format("{:.1f}", distance), "m"},
                  {"largest speed", fmt::format("{:.2f}", fastest), "m/s"},
                  {"lowest height", number(lowest, 5), "m"},
                  {"highest height", number(highest, 5), "m"}};
    return table;
}

// Heading jumps from 360 to 0 degrees: drawn as a gap instead of a line across the plot.
Series angle_series(const RunReportData& data, int axis, Ink ink, const std::string& name) {
    Series out{.name = name, .x = {}, .y = {}, .ink = ink};
    double previous = not_given;
    for (const SolutionRow& row : data.solution) {
        const double degrees = row.rpy[axis] / units::deg, t = axis_seconds(data, row.time);
        if (std::abs(degrees - previous) > 180.0) {
            out.x.push_back(t);
            out.y.push_back(not_given);
        }
        out.x.push_back(t);
        out.y.push_back(degrees);
        previous = degrees;
    }
    return out;
}

}  // namespace

Section track_section(const RunReportData& data) {
    Section section{"Track", "", {}};
    if (data.solution.empty() || !data.local) return section;
    section.intro = "East and north of the map's origin; one metre has the same length on both axes.";
    section.groups.push_back({"", {map_panel(data)}, {run_table(data)}});
    return section;
}

Section motion_section(const RunReportData& data) {
    Section section{"Motion", "Height, speed and attitude of the solution.", {}};
    if (data.solution.empty()) return section;
    Panel height = time_panel(data, "Height above the ellipsoid", "height, m");
    if (!data.reference.empty()) {
        Series r{.name = reference_name(data), .x = {}, .y = {}, .ink = Ink::Green, .width = 4.5};
        for (const ReferenceSample& sample : data.reference) {
            r.x.push_back(axis_seconds(data, sample.time));
            r.y.push_back(sample.position.h);
        }
        break_at_gaps(r);
        height.series.push_back(std::move(r));
    }
    Series fixes{.name = "GNSS (antenna)", .x = {}, .y = {}, .ink = Ink::Orange, .mark = Mark::Dots};
    for (const GnssFix& fix : data.gnss) {
        fixes.x.push_back(axis_seconds(data, fix.time));
        fixes.y.push_back(fix.position.h);
    }
    if (!fixes.x.empty()) height.series.push_back(std::move(fixes));
    Series h{.name = solution_name(data), .x = {}, .y = {}}, speed = h, climb{.name = "up", .x = {}, .y = {}, .ink = Ink::Orange};
    speed.name = "horizontal";
    for (const SolutionRow& row : data.solution) {
        h.x.push_back(axis_seconds(data, row.time));
        h.y.push_back(row.position.h);
        speed.y.push_back(row.v_eb_n.head<2>().norm());
        climb.y.push_back(-row.v_eb_n.z());
    }
    speed.x = climb.x = h.x;
    height.series.push_back(std::move(h));
    Panel velocity = time_panel(data, "Speed", "speed, m/s");
    velocity.series = {std::move(climb), std::move(speed)};
    Panel tilt = time_panel(data, "Roll and pitch", "angle, deg");
    tilt.series = {angle_series(data, 0, Ink::Blue, "roll"), angle_series(data, 1, Ink::Vermillion, "pitch")};
    Panel heading = time_panel(data, "Heading", "heading, deg");
    heading.y_limits = {0.0, 360.0};
    heading.y_step = 90.0;
    heading.series = {angle_series(data, 2, Ink::Blue, "")};
    section.groups.push_back({"", {height, velocity, tilt, heading}, {}});
    return section;
}

Section outage_section(const RunReportData& data) {
    Section section{"Outages", "", {}};
    if (data.outages.empty()) return section;
    section.intro =
        "GNSS was withheld in these intervals. The end is the first reference epoch at or after it, before its own update; "
        "inside 3σ means north and east at every epoch.";
    TableBlock table{"Errors in outages, m",
                     {"outage", "start, s", "duration, s", "end, horizontal", "largest, horizontal", "end, vertical",
                      "largest, 3-D", "inside 3σ"},
                     {}};
    Panel growth{.title = "Horizontal error in each outage",
                 .x_label = "time since the outage began, s",
                 .y_label = "error, m",
                 .time_axis = false,
                 .height = 260};
    constexpr std::array<Ink, 6> inks{Ink::Blue, Ink::Vermillion, Ink::Green, Ink::Purple, Ink::Orange, Ink::Sky};
    for (std::size_t i = 0; i < data.outages.size(); ++i) {
        const OutageEntry& o = data.outages[i];
        table.rows.push_back({fmt::format("{}", i + 1), fmt::format("{:g}", o.start_s), fmt::format("{:g}", o.duration_s),
                              number(o.end_horizontal, 3), number(o.max_horizontal, 3), number(o.end_vertical, 3),
                              number(o.max_3d, 3), o.compared ? (o.inside_3sigma ? "yes" : "no") : "not compared"});
        if (o.into_s.empty()) continue;
        growth.series.push_back({.name = fmt::format("outage {}", i + 1),
                                 .x = o.into_s,
                                 .y = o.horizontal,
                                 .ink = inks[i % inks.size()],
                                 .mark = i / inks.size() % 2 == 0 ? Mark::Line : Mark::Dashed,
                                 .width = 1.8});
    }
    Group group{"", {}, {table}};
    if (!growth.series.empty()) group.panels.push_back(std::move(growth));
    section.groups.push_back(std::move(group));
    return section;
}

}  // namespace schuler::report::detail
