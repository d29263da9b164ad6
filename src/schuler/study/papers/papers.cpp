#include "schuler/study/papers/papers.h"

#include "schuler/core/error.h"
#include "schuler/io/text/csv/csv_field.h"
#include "schuler/math/random.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/toml_file.h"
#include "schuler/study/papers/printed.h"
#include "schuler/study/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace schuler::study {
namespace {

namespace fs = std::filesystem;

/// An item with its results and the printed numbers.
struct Row {
    const PrintedValue* printed;
    double ours;
    double standard_error;  ///< 0: not a Monte Carlo number
    Agreement agreement;
};
struct Made {
    const PaperItem* item;
    const PrintedItem* printed;
    std::size_t runs;
    PaperResult result;
    std::vector<Row> rows;
};

/// The number as printed, with the kind of statement.
std::string statement_of(const PrintedValue& v) {
    switch (v.kind) {
        case PrintedValue::Kind::AtMost: return "<= " + v.printed;
        case PrintedValue::Kind::AtLeast: return ">= " + v.printed;
        case PrintedValue::Kind::Between: return v.printed + " to " + v.to;
        case PrintedValue::Kind::Equal: break;
    }
    return v.printed;
}

std::string share_of(const Row& r) {
    const double printed = number_of(r.printed->printed), difference = r.ours - printed;
    if (!std::isfinite(r.ours)) return "-";
    return printed == 0.0 ? short_number(difference, 3) : fmt::format("{:+.2g} %", 100.0 * difference / std::abs(printed));
}

/// Comparison of printed numbers and results, for display, pages and comparison.csv.
report::ResultTable comparison_of(const Made& m) {
    report::ResultTable table{"",
                              {{"key", ""},
                               {"quantity", "quantity"},
                               {"unit", "unit"},
                               {"statement", "printed"},
                               {"printed", ""},
                               {"right", ""},
                               {"ours", "ours", "", ".6g"},
                               {"standard_error", "+-", "", ".2g"},
                               {"", "difference"},
                               {"agreement", "agreement"},
                               {"remark", ""},
                               {"", "remark"}}};
    for (const Row& r : m.rows) {
        const PrintedValue& v = *r.printed;
        std::string remark = r.agreement == Agreement::Agrees ? "" : v.remark;
        if (r.agreement == Agreement::Agrees && agreement_of(v, r.ours) != Agreement::Agrees)
            remark = fmt::format("within {:g} standard errors of this number of runs", scatter_allowed);
        else if (r.agreement == Agreement::Agrees && v.tolerance && !agrees_exactly(v, r.ours))
            remark = fmt::format("within the {:g} % allowed for seed and reading", 100.0 * *v.tolerance);
        if (r.agreement == Agreement::Misprint || r.agreement == Agreement::Explained)
            remark = "right: " + v.right + "; " + remark;
        table.rows.push_back({v.key, v.quantity, v.unit, statement_of(v), v.printed, v.right, r.ours,
                              r.standard_error > 0.0 ? report::Cell(r.standard_error) : report::Cell{}, share_of(r),
                              name_of(r.agreement), v.remark, remark});
    }
    return table;
}

std::string heading_of(const Made& m) {
    return fmt::format("paper {}, {} (page {}): {}{}\n", m.item->paper, m.printed->place, m.printed->page, m.item->what,
                       m.item->runs > 0 ? fmt::format("; {} run{}", m.runs, m.runs == 1 ? "" : "s") : "");
}

std::string tables_of(const Made& m) {
    std::string out = heading_of(m);
    if (!m.rows.empty()) out += report::table_text(comparison_of(m));
    for (const report::ResultTable& t : m.result.tables) out += "\n" + report::table_text(t);
    if (!m.result.notes.empty()) out += "\n" + m.result.notes;
    return out;
}

std::size_t count(const Made& m, Agreement a) { return static_cast<std::size_t>(std::ranges::count(m.rows, a, &Row::agreement)); }

std::string summary_of(const Made& m) {
    if (m.rows.empty()) return "no number is printed";
    std::string out = fmt::format("{} of {} printed numbers agree", count(m, Agreement::Agrees), m.rows.size());
    for (const auto& [a, name] : {std::pair{Agreement::Misprint, "misprinted"}, std::pair{Agreement::Explained, "explained"},
                                  std::pair{Agreement::Differs, "NOT reached"}})
        if (const std::size_t n = count(m, a); n > 0) out += fmt::format(", {} {}", n, name);
    return out;
}

report::Json json_of(const Made& m) {
    report::Json rows = report::Json::array();
    for (const Row& r : m.rows) {
        const PrintedValue& v = *r.printed;
        // clang-format off
        rows.push_back({{"key", v.key}, {"quantity", v.quantity}, {"unit", v.unit}, {"printed", v.printed}, {"statement", statement_of(v)},
                        {"right", v.right.empty() ? report::Json(nullptr) : report::Json(number_of(v.right))}, {"ours", report::json_number(r.ours)},
                        {"standard_error", r.standard_error > 0.0 ? report::Json(r.standard_error) : report::Json(nullptr)}, {"agreement", name_of(r.agreement)}, {"exact", agrees_exactly(v, r.ours)}, {"remark", v.remark}});
        // clang-format on
    }
    report::Json plots = report::Json::array();
    for (const report::Panel& p : m.result.panels)
        plots.push_back(
            {{"title", p.title}, {"x", p.x_label}, {"y", p.y_label}, {"log_y", p.log_y}, {"equal_axes", p.equal_axes}});
    return {{"paper", m.item->paper},    {"item", m.item->name}, {"what", m.item->what}, {"page", m.printed->page},
            {"place", m.printed->place}, {"runs", m.runs},       {"rows", rows},         {"plots", plots}};
}

/// All curves, one point per line; a break in a curve is a line without y.
std::string curves_csv_of(const Made& m) {
    std::string out = "plot,curve,x,y\n";
    for (const report::Panel& p : m.result.panels)
        for (const report::Series& s : p.series)
            for (std::size_t i = 0; i < s.x.size(); ++i)
                out += fmt::format("{},{},{:.9g},{}\n", io::csv_field(p.title), io::csv_field(s.name), s.x[i],
                                   std::isfinite(s.y[i]) ? fmt::format("{:.9g}", s.y[i]) : "");
    return out;
}

report::ReportInput page_of(const Made& m, const std::string& version) {
    report::ReportInput page;
    page.title = fmt::format("Paper {}: {}", m.item->paper, m.item->what);
    page.subtitle =
        fmt::format("{}, page {}{}", m.printed->place, m.printed->page, m.item->runs > 0 ? fmt::format(", {} runs", m.runs) : "");
    page.version = version;
    page.cards.push_back({"Beside the paper", summary_of(m), {}});
    report::Section section{"Ours beside the printed", m.result.notes, {}};
    report::Group group;
    if (!m.rows.empty()) group.tables.push_back(report::table_block(comparison_of(m)));
    group.panels = m.result.panels;
    for (const report::ResultTable& t : m.result.tables) group.tables.push_back(report::table_block(t));
    section.groups.push_back(std::move(group));
    page.sections.push_back(std::move(section));
    return page;
}

void write_made(const Made& m, const fs::path& folder, const std::string& version, report::Outcome& out) {
    const fs::path outer = out.folder;  // that of all items
    report::ResultFolder files(out, folder);
    out.folder = outer;
    const auto write = [&](const std::string& name, const std::string& text) { files.write(name, text); };
    write("comparison.csv", report::table_csv(comparison_of(m)));
    if (!m.result.panels.empty()) write("curves.csv", curves_csv_of(m));
    for (std::size_t i = 0; i < m.result.tables.size(); ++i)
        write(i == 0 ? "table.csv" : fmt::format("table{}.csv", i + 1), report::table_csv(m.result.tables[i]));
    write("summary.json", report::text_of(json_of(m)));
    write("report.html", report::render(page_of(m, version)));
    files.publish();
}

Made made(const PaperItem& item, const PaperRequest& request) {
    Made m{&item, &printed_item(item.paper, item.name), item.runs, {}, {}};
    if (item.runs == 0 && request.runs > 0 && request.item != "all")
        throw input_error("this item is not a Monte Carlo campaign", {{}, 0, 0, "--runs"}, "leave it out");
    if (item.runs > 0 && request.runs > 0) m.runs = static_cast<std::size_t>(request.runs);
    m.result = item.make({m.runs, request.seed, request.jobs, request.progress});
    for (const PrintedValue& v : m.printed->values) {
        const auto ours = std::ranges::find(m.result.numbers, v.key, &std::pair<std::string, double>::first);
        const double number = ours == m.result.numbers.end() ? std::nan("") : ours->second;
        const auto& errors = m.result.standard_errors;
        const auto error = std::ranges::find(errors, v.key, &std::pair<std::string, double>::first);
        const double standard_error = error == errors.end() ? 0.0 : error->second;
        m.rows.push_back({&v, number, standard_error, agreement_of(v, number, standard_error)});
    }
    return m;
}

std::string time_of(const PaperItem& item) {
    if (item.runs == 0) return item.seconds < 1.5 ? "1 s" : fmt::format("{:.0f} s", item.seconds);
    return fmt::format("{} runs, {:.0f} s", item.runs, std::max(1.0, item.seconds * static_cast<double>(item.runs)));
}

report::Outcome listed(const PaperRequest& request) {
    report::Outcome out;
    report::Json rows = report::Json::array();
    report::ResultTable table =
        report::table_for_people(fmt::format("paper {}", request.paper), {"item", "page", "numbers", "takes", "what"});
    for (const PaperItem& item : paper_items()) {
        if (item.paper != request.paper) continue;
        const PrintedItem& printed = printed_item(item.paper, item.name);
        table.rows.push_back({item.name, printed.page, printed.values.size(), time_of(item), item.what});
        // clang-format off
        rows.push_back({{"item", item.name}, {"what", item.what}, {"page", printed.page}, {"place", printed.place}, {"printed_numbers", printed.values.size()},
                        {"runs", item.runs}, {"seconds", item.runs > 0 ? item.seconds * static_cast<double>(item.runs) : item.seconds}});
        // clang-format on
    }
    out.tables =
        report::table_text(table) +
        fmt::format(
            "\n`schuler paper {} ITEM [-o DIR]` makes one, `schuler paper {} all` all of them but the Monte Carlo campaigns\n",
            request.paper, request.paper);
    out.json = report::text_of(report::Json{{"paper", request.paper}, {"items", rows}});
    return out;
}

}  // namespace

const std::vector<PaperItem>& paper_items() {
    static const std::vector<PaperItem> all = [] {
        std::vector<PaperItem> out;
        for (const auto make : {paper_a_systems, paper_a_receiver, paper_a_algorithms, paper_a_errors, paper_a_flight,
                                paper_b_items, paper_c_items, paper_d_items, paper_e_items, paper_e_laboratory})
            for (PaperItem& item : make()) out.push_back(item);
        return out;
    }();
    return all;
}

settings::SettingList paper_settings(std::string_view file, std::uint64_t seed, const settings::SettingList& over) {
    const std::string origin(file);
    settings::SettingList all = settings::scenario_table().read(settings::parse_toml(embedded_file(file), origin), origin);
    all.push_back({"seed", {static_cast<std::int64_t>(seed)}, {}});
    all.insert(all.end(), over.begin(), over.end());
    return all;
}

settings::ScenarioConfig paper_scenario(std::string_view file, std::uint64_t seed, const settings::SettingList& over) {
    return settings::scenario_from(paper_settings(file, seed, over));
}

double paper_rms(const std::vector<double>& x) {
    double sum = 0.0;
    for (const double v : x) sum += v * v;
    return std::sqrt(sum / static_cast<double>(x.size()));
}

void set_numbers(PaperResult& result, std::size_t runs, const NumbersOfRuns& numbers) {
    std::vector<std::size_t> which(runs);
    std::iota(which.begin(), which.end(), std::size_t{0});
    const auto all = numbers(which);
    result.numbers.insert(result.numbers.end(), all.begin(), all.end());
    if (runs < 2) return;
    constexpr int draws = 200;
    math::Random random(1, "paper.bootstrap");
    std::vector<double> sum(all.size()), squares(all.size());
    for (int draw = 0; draw < draws; ++draw) {
        for (std::size_t& i : which)
            i = std::min(static_cast<std::size_t>(random.uniform() * static_cast<double>(runs)), runs - 1);
        const auto drawn = numbers(which);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double off = drawn[i].second - all[i].second;
            sum[i] += off / draws;
            squares[i] += off * off / draws;
        }
    }
    // n drawn values scatter less than n new ones
    const double few = static_cast<double>(runs) / static_cast<double>(runs - 1);
    for (std::size_t i = 0; i < all.size(); ++i)
        result.standard_errors.emplace_back(all[i].first, std::sqrt(few * std::max(0.0, squares[i] - sum[i] * sum[i])));
}

report::Outcome make_paper(const PaperRequest& request) {
    if (request.item.empty()) return listed(request);
    report::Outcome out;
    report::Json all = report::Json::array();
    std::size_t differing = 0;
    std::string last;
    for (const PaperItem& item : paper_items()) {
        if (item.paper != request.paper || (request.item == "all" ? item.runs > 0 : request.item != item.name)) continue;
        const Made m = made(item, request);
        out.tables += (out.tables.empty() ? "" : "\n") + tables_of(m);
        all.push_back(json_of(m));
        differing += count(m, Agreement::Differs);
        last = summary_of(m);
        if (!request.output.empty()) {
            out.folder = request.output;
            write_made(m, request.item == "all" ? request.output / item.name : request.output, request.version, out);
        }
    }
    if (all.empty()) static_cast<void>(printed_item(request.paper, request.item));  // the error lists the existing ones
    out.usable = differing == 0;
    out.verdict = request.item == "all" ? (differing == 0 ? "every printed number agrees or is explained"
                                                          : fmt::format("{} printed numbers are not reached", differing))
                                        : last;
    out.json = report::text_of(request.item == "all" ? report::Json{{"paper", request.paper}, {"items", all}} : all.front());
    return out;
}

}  // namespace schuler::study
