// Paper D's experiments as a table compared with the reference simulation of math.md 5.5.
#include "schuler/core/parallel.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/report/result_table.h"
#include "schuler/study/parts.h"
#include "schuler/study/studies.h"
#include "schuler/study/triad/triad.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

/// Horizontal errors of a case by second, root mean square over the runs, m.
struct CovarianceCourse {
    std::vector<double> observed = std::vector<double>(triad_epochs), predicted = std::vector<double>(triad_epochs);
};

struct Done {
    TriadCase which;
    TriadStatistics statistics;
    double one_set = 0.0;         ///< m, standard error of 48 runs
    double standard_error = 0.0;  ///< m, of all runs here
    CovarianceCourse course;
};

std::vector<TriadCase> wanted_cases(const TriadRequest& r) {
    const bool tactical = r.grade == "tactical", tcxo = r.oscillator == "tcxo", ecef = r.mechanization == "ecef";
    constexpr double usual_baro = 30.0;
    const bool chosen = !r.grade.empty() || !r.oscillator.empty() || r.baro.has_value();
    std::vector<TriadCase> out = chosen ? triad_cases_with(tactical, tcxo, r.baro.value_or(usual_baro)) : triad_cases();
    std::erase_if(out, [&](const TriadCase& c) { return !r.cases.empty() && r.cases.find(c.key) == std::string::npos; });
    for (TriadCase& c : out) c.mechanization = ecef ? fusion::Mechanization::Ecef : fusion::Mechanization::Geographic;
    return out;
}

Done finished(const TriadCase& which, const std::vector<TriadRun>& runs) {
    Done d{which, statistics_of(runs), standard_error_of_a_set(runs), 0.0, {}};
    d.standard_error =
        d.one_set * std::sqrt(std::min(1.0, static_cast<double>(triad_geometries) / static_cast<double>(runs.size())));
    for (std::size_t i = 0; i < triad_epochs; ++i) {
        for (const TriadRun& r : runs) {
            d.course.observed[i] += r.horizontal[i] * r.horizontal[i] / static_cast<double>(runs.size());
            d.course.predicted[i] += r.predicted_horizontal[i] * r.predicted_horizontal[i] / static_cast<double>(runs.size());
        }
        d.course.observed[i] = std::sqrt(d.course.observed[i]);
        d.course.predicted[i] = std::sqrt(d.course.predicted[i]);
    }
    return d;
}

/// Difference from the reference in combined standard errors; the reference has the scatter of one set of 48 runs.
double deviation(const Done& d) {
    return d.which.reference ? (d.statistics.pooled - d.which.reference->pooled) / std::hypot(d.one_set, d.standard_error)
                             : not_given;
}

double reference_of(const Done& d, double TriadReference::*field) {
    return d.which.reference ? (*d.which.reference).*field : not_given;
}

/// For display, and triad.csv.
report::ResultTable table_of_cases(std::string title, const std::vector<Done>& all) {
    using report::Cell;
    // clang-format off
    static const std::vector<report::ColumnOf<Done>> columns{
        {{"case", "case"}, [](const Done& d) { return Cell(d.which.name); }},
        {{"pooled_m", "pooled", "m", ".3g", ".6g"}, [](const Done& d) { return Cell(d.statistics.pooled); }},
        {{"standard_error_m", "+-", "m", ".2g", ".6g"}, [](const Done& d) { return Cell(d.standard_error); }},
        {{"predicted_m", "predicted", "m", ".3g", ".6g"}, [](const Done& d) { return Cell(d.statistics.predicted); }},
        {{"reference_pooled_m", "reference pooled", "m", ".3g", ".6g"}, [](const Done& d) { return Cell(reference_of(d, &TriadReference::pooled)); }},
        {{"reference_predicted_m", "predicted", "m", ".3g", ".6g"}, [](const Done& d) { return Cell(reference_of(d, &TriadReference::predicted)); }},
        {{"", "sigmas", "", ".2g"}, [](const Done& d) { return Cell(deviation(d)); }},
        {{"", "vertical", "m", ".3g"}, [](const Done& d) { return Cell(d.statistics.vertical); }},
        {{"", "at 600 s", "m", ".3g"}, [](const Done& d) { return Cell(d.statistics.end); }},
        {{"nees_position", "NEES/3", "", ".2f", ".6g"}, [](const Done& d) { return Cell(d.statistics.nees3); }},
        {{"nees_nine", "NEES/9", "", ".2f", ".6g"}, [](const Done& d) { return Cell(d.statistics.nees9); }}};
    // clang-format on
    return report::table_of<Done>(std::move(title), columns, all);
}

report::Json json_of(const Done& d) {
    const TriadStatistics& s = d.statistics;
    report::Json row{{"case", d.which.name},
                     {"key", std::string(1, d.which.key)},
                     {"horizontal_m",
                      {{"pooled", s.pooled},
                       {"predicted", s.predicted},
                       {"standard_error", d.standard_error},
                       {"standard_error_of_48", d.one_set},
                       {"median", s.median},
                       {"low", s.low},
                       {"high", s.high}}},
                     {"vertical_m", {{"pooled", s.vertical}, {"predicted", s.predicted_vertical}}},
                     {"two_sigma_3d_m", s.two_sigma},
                     {"at_600_s_m", {{"pooled", s.end}, {"predicted", s.predicted_end}}},
                     {"switch_on_ratio", d.which.stations_on > 0.0 ? report::Json(s.at_300 / s.at_330) : report::Json(nullptr)},
                     {"nees_position", s.nees3},
                     {"nees_nine", s.nees9},
                     {"reference", nullptr}};
    if (d.which.reference) {
        const TriadReference& r = *d.which.reference;
        row["reference"] = {{"pooled", r.pooled},     {"predicted", r.predicted},
                            {"vertical", r.vertical}, {"predicted_vertical", r.predicted_vertical},
                            {"at_600_s", r.end},      {"nees_position", r.nees3},
                            {"nees_nine", r.nees9},   {"deviation_sigmas", deviation(d)}};
    }
    return row;
}

/// Ratio of cases c and e with the same instruments, at 600 s.
double ratio_of(const std::vector<Done>& all) {
    for (const Done& c : all)
        for (const Done& e : all)
            if (c.which.key == 'c' && e.which.key == 'e' && c.which.tactical == e.which.tactical &&
                c.which.tcxo == e.which.tcxo && c.which.baro == e.which.baro)
                return c.statistics.end / e.statistics.end;
    return not_given;
}

void write_files(const TriadRequest& request, const std::vector<Done>& all, const report::ResultTable& table,
                 report::Outcome& out) {
    report::ResultFolder files(out, request.output);
    std::string course = "time_s";
    for (const Done& d : all) course += fmt::format(",{0} observed_m,{0} predicted_m", d.which.name);
    report::ReportInput page{"The triad of paper D",
                             fmt::format("{} runs of each case from seed {}", request.runs, request.seed)};
    page.version = request.version;
    report::Section section{"Horizontal error after the loss",
                            "Root mean square over the runs; broken: one sigma of the filter."};
    std::vector<double> t(triad_epochs);
    for (std::size_t i = 0; i < triad_epochs; ++i) {
        t[i] = static_cast<double>(i);
        course += fmt::format("\n{}", i);
        for (const Done& d : all) course += fmt::format(",{:.5g},{:.5g}", d.course.observed[i], d.course.predicted[i]);
    }
    for (const Done& d : all) {
        report::Panel panel{d.which.name, "time after the loss, s", "horizontal error, m"};
        panel.series.push_back({"observed", t, d.course.observed, report::Ink::Blue, report::Mark::Line});
        panel.series.push_back({"predicted", t, d.course.predicted, report::Ink::Vermillion, report::Mark::Dashed});
        section.groups.push_back({"", {panel}, {}});
    }
    section.groups.push_back({"", {}, {report::table_block(table)}});
    page.sections.push_back(section);
    files.write("triad.csv", report::table_csv(table));
    files.write("course.csv", course + "\n");
    files.write("summary.json", out.json);
    files.write("report.html", report::render(page));
    files.publish();
}

}  // namespace

report::Outcome analyze_triad(const TriadRequest& request) {
    const std::vector<TriadCase> cases = wanted_cases(request);
    std::vector<Done> all;
    for (const TriadCase& which : cases) {
        std::vector<TriadRun> runs(request.runs);
        const auto progress = [&](double part) {
            if (request.progress) request.progress((static_cast<double>(all.size()) + part) / static_cast<double>(cases.size()));
        };
        for_each_run(
            runs.size(), request.jobs,
            [&](std::size_t j) { runs[j] = run_triad(which, j % triad_geometries, request.seed + j / triad_geometries); },
            progress);
        all.push_back(finished(which, runs));
    }
    report::Outcome out;
    const report::ResultTable table =
        table_of_cases(fmt::format("paper D's triad, {} runs of each case from seed {}; horizontal, 300 to 600 s after the loss",
                                   request.runs, request.seed),
                       all);
    out.tables = report::table_text(table);
    report::Json rows = report::Json::array();
    for (const Done& d : all) rows.push_back(json_of(d));
    const double ratio = ratio_of(all);
    if (std::isfinite(ratio)) out.tables += fmt::format("c/e at 600 s: {:.2f} (paper D and math.md: about 5)\n", ratio);
    for (const Done& d : all)
        if (d.which.stations_on > 0.0)
            out.tables +=
                fmt::format("{}: {:.1f} m before, {:.1f} m 30 s later\n", d.which.name, d.statistics.at_300, d.statistics.at_330);
    out.tables += "+-: standard error of the runs here; sigmas: difference from the reference, whose 48 runs scatter likewise\n";
    out.json = report::text_of(report::Json{
        {"runs", request.runs}, {"seed", request.seed}, {"ratio_c_e_at_600_s", report::json_number(ratio)}, {"rows", rows}});
    if (!request.output.empty()) write_files(request, all, table, out);
    return out;
}

}  // namespace schuler::study
