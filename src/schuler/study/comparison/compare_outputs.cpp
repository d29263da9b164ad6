#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/solution/bundle.h"
#include "schuler/study/comparison/compare.h"
#include "schuler/study/comparison/compare_windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

double outage(const solution::ResultBundle& b, double analysis::OutageStatistics::*field) {
    return b.evaluation.outages.empty() ? not_given : b.evaluation.outages.front().*field;
}

/// The numbers of the comparison.
struct Column {
    report::TableColumn column;
    double (*of)(const solution::ResultBundle&);
};
const std::array<Column, 10> columns{{
    {{"horizontal_m", "horizontal", "m"}, [](const solution::ResultBundle& b) { return b.evaluation.summary.horizontal.rms; }},
    {{"up_m", "up", "m"}, [](const solution::ResultBundle& b) { return b.evaluation.summary.up.rms; }},
    {{"velocity_m_s", "velocity", "m/s"},
     [](const solution::ResultBundle& b) {
         const analysis::ErrorSummary& s = b.evaluation.summary;
         return std::hypot(s.v_east.rms, s.v_north.rms, s.v_up.rms);
     }},
    {{"tilt_deg", "tilt", "deg"},
     [](const solution::ResultBundle& b) {
         return std::hypot(b.evaluation.summary.roll.rms, b.evaluation.summary.pitch.rms) / units::deg;
     }},
    {{"heading_deg", "heading", "deg"},
     [](const solution::ResultBundle& b) { return b.evaluation.summary.heading.rms / units::deg; }},
    {{"nees_position", "NEES of position"},
     [](const solution::ResultBundle& b) {
         return b.evaluation.consistency ? b.evaluation.consistency->position.mean / 3.0 : not_given;
     }},
    {{"outage_end_horizontal_m", "end of the outage", "m"},
     [](const solution::ResultBundle& b) { return outage(b, &analysis::OutageStatistics::end_horizontal); }},
    {{"outage_end_vertical_m", "its height", "m"},
     [](const solution::ResultBundle& b) { return outage(b, &analysis::OutageStatistics::end_vertical); }},
    {{"gnss_rejected", "fixes rejected", "", ".4g"},
     [](const solution::ResultBundle& b) { return static_cast<double>(b.result.counters.gnss_rejected); }},
    {{"filter_s", "time of the filter", "s"}, [](const solution::ResultBundle& b) { return b.timing.filter_s; }},
}};

bool has_receiver(const Comparison& c) {
    return std::ranges::any_of(c.runs, [](const ComparedRun& r) { return !r.receiver.empty(); });
}

}  // namespace

std::vector<double> compared_numbers(const solution::ResultBundle& bundle) {
    std::vector<double> out;
    for (const Column& c : columns) out.push_back(c.of(bundle));
    return out;
}

const std::vector<report::TableColumn>& compared_columns() {
    static const std::vector<report::TableColumn> list = [] {
        std::vector<report::TableColumn> out;
        for (const Column& c : columns) out.push_back(c.column);
        return out;
    }();
    return list;
}

std::vector<report::TableColumn> repeated_columns() {
    std::vector<report::TableColumn> list = compared_columns();
    list.pop_back();
    return list;
}

std::vector<report::TableColumn> window_columns(const Comparison& comparison) {
    std::vector<report::TableColumn> list{{"horizontal_rms_m", "horizontal, rms", "m"},
                                          {"horizontal_max_m", "largest", "m"},
                                          {"vertical_max_m", "vertical, largest", "m"},
                                          {"solution_share", "solution", "", ".4g"},
                                          {"recovery_s", "recovery", "s"}};
    if (has_receiver(comparison)) {
        list.push_back({"held_db_hz", "held", "dB-Hz"});
        list.push_back({"back_s", "back", "s"});
    }
    return list;
}

std::vector<double> window_numbers(const WindowStatistics& s) {
    return {s.horizontal_rms, s.horizontal_max, s.vertical_max, s.share, s.recovery, s.held, s.back};
}

std::string window_title(const settings::CompareWindow& w) {
    return fmt::format("window {}, {:g} to {:g} s", w.name, w.start, w.end);
}

std::string window_note(const Comparison& c) {
    std::string out = fmt::format(
        "solution: share of the time with one not older than {:g} s; recovery: time "
        "after the window until the horizontal error is below {:g} m for {:g} s",
        c.rules.age, c.rules.limit, c.rules.hold);
    if (has_receiver(c))
        out +=
            "; held: lowest C/N0 with four satellites followed; back: time after the window until four, or all there are, are "
            "followed";
    return out;
}

report::ResultTable table_of_schemes(std::string title, bool satellites, const std::vector<report::TableColumn>& numbers) {
    report::ResultTable table{std::move(title), {{"", "scheme"}, {"scheme", ""}}};
    if (satellites) table.columns.push_back({"satellites", "satellites"});
    table.columns.insert(table.columns.end(), numbers.begin(), numbers.end());
    return table;
}

std::vector<report::Cell> row_of_scheme(const settings::KnownScheme& scheme, std::optional<std::size_t> satellites,
                                        const std::vector<double>& numbers) {
    std::vector<report::Cell> row{scheme.title, scheme.name};
    if (satellites) row.emplace_back(*satellites);
    row.insert(row.end(), numbers.begin(), numbers.end());
    return row;
}

report::ResultTable scheme_table(const Comparison& c, bool timing) {
    report::ResultTable table = table_of_schemes(c.name, c.with_satellites(), timing ? compared_columns() : repeated_columns());
    for (const ComparedRun& run : c.runs) table.rows.push_back(row_of_scheme(*run.scheme, run.satellites, run.numbers));
    return table;
}

report::ResultTable window_table(const Comparison& c, std::size_t window) {
    report::ResultTable table = table_of_schemes(window_title(c.windows[window]), c.with_satellites(), window_columns(c));
    for (const ComparedRun& run : c.runs)
        table.rows.push_back(row_of_scheme(*run.scheme, run.satellites, window_numbers(run.windows[window])));
    return table;
}

std::string comparison_tables(const Comparison& c) {
    std::string out = report::table_text(scheme_table(c, true));
    out +=
        "root mean squares after settling; NEES of the position over its three degrees of freedom (1: consistent); the first "
        "outage's end\n";
    for (std::size_t k = 0; k < c.windows.size(); ++k) out += "\n" + report::table_text(window_table(c, k));
    if (c.windows.empty()) return out;
    std::string note = window_note(c);
    for (const char* part : {"; recovery", "; held"})
        if (const auto at = note.find(part); at != std::string::npos) note.replace(at, 2, ";\n");
    return out + note + "\n";
}

std::string comparison_csv(const Comparison& c) { return report::table_csv(scheme_table(c, false)); }

std::string windows_csv(const Comparison& c) {
    std::vector<report::TableColumn> columns = window_columns(c);
    columns.insert(columns.begin(), {{"window", ""}, {"start_s", ""}, {"end_s", ""}});
    report::ResultTable table = table_of_schemes(c.name, c.with_satellites(), columns);
    for (const ComparedRun& run : c.runs) {
        for (std::size_t k = 0; k < c.windows.size(); ++k) {
            const settings::CompareWindow& w = c.windows[k];
            std::vector<report::Cell>& row = table.rows.emplace_back(row_of_scheme(*run.scheme, run.satellites, {}));
            row.insert(row.end(), {w.name, w.start, w.end});
            for (const double x : window_numbers(run.windows[k])) row.emplace_back(x);
        }
    }
    return report::table_csv(table);
}

std::string comparison_json(const Comparison& c) {
    report::Json rows = report::Json::array();
    const std::vector<report::TableColumn> head = window_columns(c);
    for (const ComparedRun& run : c.runs) {
        report::Json row{{"scheme", run.scheme->name}};
        if (run.satellites) row["satellites"] = *run.satellites;
        report::put_row(row, compared_columns(), {run.numbers.begin(), run.numbers.end()});
        for (std::size_t k = 0; k < c.windows.size(); ++k) {
            report::Json window{{"name", c.windows[k].name}, {"start_s", c.windows[k].start}, {"end_s", c.windows[k].end}};
            const std::vector<double> numbers = window_numbers(run.windows[k]);
            report::put_row(window, head, {numbers.begin(), numbers.end()});
            row["windows"].push_back(std::move(window));
        }
        rows.push_back(std::move(row));
    }
    return report::text_of(
        report::Json{{"name", c.name}, {"command", "run"}, {"seed", c.seed}, {"schemes", rows}, {"warnings", c.warnings}});
}

}  // namespace schuler::study
