#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
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

/// A number of the comparison: key of JSON and CSV, title of the table, and how it is got.
struct Column {
    ComparedColumn column;
    double (*of)(const solution::ResultBundle&);
};
const std::array<Column, 10> columns{{
    {{"horizontal_m", "horiz., m"}, [](const solution::ResultBundle& b) { return b.evaluation.summary.horizontal.rms; }},
    {{"up_m", "up, m"}, [](const solution::ResultBundle& b) { return b.evaluation.summary.up.rms; }},
    {{"velocity_m_s", "vel., m/s"},
     [](const solution::ResultBundle& b) {
         const analysis::ErrorSummary& s = b.evaluation.summary;
         return std::hypot(s.v_east.rms, s.v_north.rms, s.v_up.rms);
     }},
    {{"tilt_deg", "tilt, deg"},
     [](const solution::ResultBundle& b) {
         return std::hypot(b.evaluation.summary.roll.rms, b.evaluation.summary.pitch.rms) / units::deg;
     }},
    {{"heading_deg", "head., deg"}, [](const solution::ResultBundle& b) { return b.evaluation.summary.heading.rms / units::deg; }},
    {{"nees_position", "NEES pos."},
     [](const solution::ResultBundle& b) { return b.evaluation.consistency ? b.evaluation.consistency->position.mean / 3.0 : not_given; }},
    {{"outage_end_horizontal_m", "outage, m"},
     [](const solution::ResultBundle& b) { return outage(b, &analysis::OutageStatistics::end_horizontal); }},
    {{"outage_end_vertical_m", "vertical, m"},
     [](const solution::ResultBundle& b) { return outage(b, &analysis::OutageStatistics::end_vertical); }},
    {{"gnss_rejected", "rejected"}, [](const solution::ResultBundle& b) { return static_cast<double>(b.result.counters.gnss_rejected); }},
    {{"filter_s", "time, s"}, [](const solution::ResultBundle& b) { return b.timing.filter_s; }},
}};

std::string cell(double x) {
    if (!std::isfinite(x)) return "-";
    const double a = std::abs(x);
    return a != 0.0 && (a < 1e-3 || a >= 1e5) ? fmt::format("{:.2e}", x) : fmt::format("{:.4g}", x);
}

std::string csv_number(double x) { return std::isfinite(x) ? fmt::format(",{:.9g}", x) : ","; }

bool has_receiver(const Comparison& c) {
    return std::ranges::any_of(c.runs, [](const ComparedRun& r) { return !r.receiver.empty(); });
}

/// "scheme", with the number of satellites where there is one.
std::string csv_name(const ComparedRun& run) {
    return run.scheme->name + (run.satellites ? fmt::format(",{}", *run.satellites) : "");
}
std::string csv_name_header(const Comparison& c) { return c.runs.front().satellites ? "scheme,satellites" : "scheme"; }

/// A row a run under its number of satellites; numbers: of a run.
template <class Numbers>
std::string table_of(const Comparison& c, const std::string& title, const std::vector<ComparedColumn>& head, Numbers numbers) {
    std::string out = fmt::format("{:<36}", title);
    for (const ComparedColumn& column : head) out += fmt::format("{:>13}", column.title);
    out += "\n";
    std::optional<std::size_t> satellites;
    for (const ComparedRun& run : c.runs) {
        if (run.satellites != satellites) out += fmt::format("{} satellites\n", *run.satellites);
        satellites = run.satellites;
        out += fmt::format("  {:<34}", run.scheme->title);
        const std::vector<double> values = numbers(run);
        for (std::size_t i = 0; i < head.size(); ++i) out += fmt::format("{:>13}", cell(values[i]));
        out += "\n";
    }
    return out;
}

}  // namespace

std::vector<double> compared_numbers(const solution::ResultBundle& bundle) {
    std::vector<double> out;
    for (const Column& c : columns) out.push_back(c.of(bundle));
    return out;
}

const std::vector<ComparedColumn>& compared_columns() {
    static const std::vector<ComparedColumn> list = [] {
        std::vector<ComparedColumn> out;
        for (const Column& c : columns) out.push_back(c.column);
        return out;
    }();
    return list;
}

std::vector<ComparedColumn> repeated_columns() {
    std::vector<ComparedColumn> list = compared_columns();
    list.pop_back();
    return list;
}

std::vector<ComparedColumn> window_columns(const Comparison& comparison) {
    std::vector<ComparedColumn> list{{"horizontal_rms_m", "h. rms, m"},
                                     {"horizontal_max_m", "h. max, m"},
                                     {"vertical_max_m", "v. max, m"},
                                     {"solution_share", "solution"},
                                     {"recovery_s", "recovery, s"}};
    if (has_receiver(comparison)) {
        list.push_back({"held_db_hz", "held, dB-Hz"});
        list.push_back({"back_s", "back, s"});
    }
    return list;
}

std::vector<double> window_numbers(const WindowStatistics& s) {
    return {s.horizontal_rms, s.horizontal_max, s.vertical_max, s.share, s.recovery, s.held, s.back};
}

std::string window_title(const settings::CompareWindow& w) { return fmt::format("window {}, {:g} to {:g} s", w.name, w.start, w.end); }

std::string window_note(const Comparison& c) {
    std::string out = fmt::format(
        "h., v.: horizontal and vertical error; solution: share of the time with one not older than {:g} s; recovery: time "
        "after the window until the horizontal error is below {:g} m for {:g} s",
        c.rules.age, c.rules.limit, c.rules.hold);
    if (has_receiver(c))
        out +=
            "; held: lowest C/N0 with four satellites followed; back: time after the window until four, or all there are, are "
            "followed";
    return out;
}

std::string comparison_tables(const Comparison& c) {
    std::string out = table_of(c, c.name, compared_columns(), [](const ComparedRun& r) { return r.numbers; });
    out +=
        "root mean squares after settling; NEES of the position over its three degrees of freedom (1: honest); the first "
        "outage's end\n";
    for (std::size_t k = 0; k < c.windows.size(); ++k)
        out += "\n" + table_of(c, window_title(c.windows[k]), window_columns(c),
                               [k](const ComparedRun& r) { return window_numbers(r.windows[k]); });
    if (c.windows.empty()) return out;
    std::string note = window_note(c);
    for (const char* part : {"; recovery", "; held"})
        if (const auto at = note.find(part); at != std::string::npos) note.replace(at, 2, ";\n");
    return out + note + "\n";
}

std::string comparison_csv(const Comparison& c) {
    std::string out = csv_name_header(c);
    const std::vector<ComparedColumn> head = repeated_columns();
    for (const ComparedColumn& column : head) out += fmt::format(",{}", column.key);
    for (const ComparedRun& run : c.runs) {
        out += "\n" + csv_name(run);
        for (std::size_t i = 0; i < head.size(); ++i) out += csv_number(run.numbers[i]);
    }
    return out + "\n";
}

std::string windows_csv(const Comparison& c) {
    std::string out = csv_name_header(c) + ",window,start_s,end_s";
    const std::vector<ComparedColumn> head = window_columns(c);
    for (const ComparedColumn& column : head) out += fmt::format(",{}", column.key);
    for (const ComparedRun& run : c.runs) {
        for (std::size_t k = 0; k < c.windows.size(); ++k) {
            const settings::CompareWindow& w = c.windows[k];
            out += fmt::format("\n{},{},{:.9g},{:.9g}", csv_name(run), w.name, w.start, w.end);
            const std::vector<double> numbers = window_numbers(run.windows[k]);
            for (std::size_t i = 0; i < head.size(); ++i) out += csv_number(numbers[i]);
        }
    }
    return out + "\n";
}

std::string comparison_json(const Comparison& c) {
    report::Json rows = report::Json::array();
    const std::vector<ComparedColumn> head = window_columns(c);
    for (const ComparedRun& run : c.runs) {
        report::Json row{{"scheme", run.scheme->name}};
        if (run.satellites) row["satellites"] = *run.satellites;
        for (std::size_t i = 0; i < run.numbers.size(); ++i) row[compared_columns()[i].key] = report::json_number(run.numbers[i]);
        for (std::size_t k = 0; k < c.windows.size(); ++k) {
            report::Json window{{"name", c.windows[k].name}, {"start_s", c.windows[k].start}, {"end_s", c.windows[k].end}};
            const std::vector<double> numbers = window_numbers(run.windows[k]);
            for (std::size_t i = 0; i < head.size(); ++i) window[head[i].key] = report::json_number(numbers[i]);
            row["windows"].push_back(std::move(window));
        }
        rows.push_back(std::move(row));
    }
    return report::text_of(report::Json{{"name", c.name}, {"command", "run"}, {"seed", c.seed}, {"schemes", rows}});
}

}  // namespace schuler::study
