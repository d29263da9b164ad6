// Schemes over seeds as tables, as JSON and as CSV.
#include "schuler/report/inner/json.h"
#include "schuler/report/published.h"
#include "schuler/report/result_table.h"
#include "schuler/study/comparison/compare.h"
#include "schuler/study/comparison/compare_campaign.h"
#include "schuler/study/comparison/compare_windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace schuler::study {
namespace {

constexpr std::array<const char*, 3> nees_keys{"nees_position", "nees_velocity", "nees_attitude"};
constexpr std::string_view single_nees = "nees_position";  ///< of compared_columns: replaced by that of the ensemble

/// Root mean square of a number over the runs with a value.
double rms_of(const std::vector<std::vector<double>>& runs, std::size_t i) {
    double sum = 0.0, n = 0.0;
    for (const std::vector<double>& numbers : runs) {
        if (i >= numbers.size() || !std::isfinite(numbers[i])) continue;
        sum += numbers[i] * numbers[i];
        n += 1.0;
    }
    return n > 0.0 ? std::sqrt(sum / n) : not_given;
}

/// For a window over the runs: RMS of the RMS, largest of the largest, mean share, median recovery, and receiver values.
std::vector<double> window_of(const SchemeCampaign& s, std::size_t window) {
    std::vector<std::vector<double>> columns;
    for (const std::vector<WindowStatistics>& run : s.windows) {
        if (window >= run.size()) continue;
        const std::vector<double> numbers = window_numbers(run[window]);
        columns.resize(numbers.size());
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (std::isfinite(numbers[i])) columns[i].push_back(numbers[i]);
    }
    std::vector<double> out;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const std::vector<double>& x = columns[i];
        if (x.empty()) out.push_back(not_given);
        else if (i == 0) out.push_back(analysis::quantiles_of(x).rms);
        else if (i < 3) out.push_back(*std::ranges::max_element(x));
        else if (i == 3) out.push_back(std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size()));
        else out.push_back(analysis::quantiles_of(x).median);
    }
    return out;
}

/// Columns repeatable for the same seed, with their index among the numbers.
std::vector<std::pair<std::size_t, report::TableColumn>> counted_columns() {
    std::vector<std::pair<std::size_t, report::TableColumn>> out;
    const std::vector<report::TableColumn> all = repeated_columns();
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].key != single_nees) out.emplace_back(i, all[i]);
    return out;
}

}  // namespace

/// Consistency over the runs, for display.
report::ResultTable nees_table(const CompareCampaign& c) {
    report::ResultTable table = table_of_schemes("NEES, 3 expected, with the 95 % bounds of as many runs", c.with_satellites(),
                                                 {{"", "position"}, {"", "velocity"}, {"", "attitude"}, {"", "runs failed"}});
    for (const SchemeCampaign& s : c.schemes) {
        std::vector<report::Cell>& row = table.rows.emplace_back(row_of_scheme(*s.scheme, s.satellites, {}));
        for (const analysis::EnsembleConsistency& n : s.nees)
            row.push_back(std::isfinite(n.mean)
                              ? fmt::format("{:.2f} ({:.2f} to {:.2f}){}", n.mean, n.low95, n.high95, n.in_band() ? "" : " OUT")
                              : report::Cell{});
        row.emplace_back(s.failures.size());
    }
    return table;
}

std::string campaign_tables(const CompareCampaign& c) {
    std::vector<report::TableColumn> columns;
    for (const auto& [i, column] : counted_columns()) columns.push_back(column);
    report::ResultTable settled =
        table_of_schemes(fmt::format("{}, {} runs each", c.name, c.seeds.size()), c.with_satellites(), columns);
    for (const SchemeCampaign& s : c.schemes) {
        std::vector<double> numbers;
        for (const auto& [i, column] : counted_columns()) numbers.push_back(rms_of(s.numbers, i));
        settled.rows.push_back(row_of_scheme(*s.scheme, s.satellites, numbers));
    }
    std::string out = report::table_text(settled);
    out += fmt::format("root mean squares over the runs, seeds {} to {}\n\n", c.seeds.front(), c.seeds.back());
    out += report::table_text(nees_table(c));
    for (std::size_t k = 0; k < c.windows.size(); ++k) {
        report::ResultTable window = table_of_schemes(window_title(c.windows[k]), c.with_satellites(), window_columns({}));
        for (const SchemeCampaign& s : c.schemes) window.rows.push_back(row_of_scheme(*s.scheme, s.satellites, window_of(s, k)));
        out += "\n" + report::table_text(window);
    }
    if (!c.windows.empty())
        out += "over the runs: RMS, the largest, the largest, mean share of the time with a solution, median recovery\n";
    return out + fmt::format("\n{:.1f} s, {:.2f} runs/s\n", c.wall_s,
                             static_cast<double>(c.seeds.size() * c.schemes.size()) / c.wall_s);
}

std::string campaign_json(const CompareCampaign& c) {
    report::Json rows = report::Json::array();
    std::size_t failed = 0;
    for (const SchemeCampaign& s : c.schemes) {
        report::Json row{{"scheme", s.scheme->name}};
        if (s.satellites) row["satellites"] = *s.satellites;
        row["failed"] = s.failures.size();
        failed += s.failures.size();
        for (const auto& [i, column] : counted_columns()) row[column.key] = report::json_number(rms_of(s.numbers, i));
        for (std::size_t block = 0; block < 3; ++block) {
            const analysis::EnsembleConsistency& n = s.nees[block];
            row[nees_keys[block]] = std::isfinite(n.mean) ? report::Json{{"mean", n.mean},
                                                                         {"expected", n.expected},
                                                                         {"low95", report::json_number(n.low95)},
                                                                         {"high95", report::json_number(n.high95)},
                                                                         {"inside", report::json_number(n.inside)},
                                                                         {"worth", report::json_number(n.worth)}}
                                                          : report::Json(nullptr);
        }
        for (std::size_t k = 0; k < c.windows.size(); ++k) {
            report::Json window{{"name", c.windows[k].name}, {"start_s", c.windows[k].start}, {"end_s", c.windows[k].end}};
            const std::vector<double> numbers = window_of(s, k);
            report::put_row(window, window_columns({}), {numbers.begin(), numbers.end()});
            row["windows"].push_back(std::move(window));
        }
        rows.push_back(std::move(row));
    }
    const auto all = static_cast<double>(c.seeds.size() * c.schemes.size());
    return report::text_of(report::Json{
        {"name", c.name},
        {"command", "montecarlo"},
        {"version", c.version},
        {"seed", c.seeds.front()},
        {"schemes", rows},
        // clang-format off
                        {"montecarlo", {{"runs", c.seeds.size()}, {"failed", failed}, {"runs_per_s", report::json_number(all / c.wall_s)}}},
                        {"timing", {{"wall_s", c.wall_s}}},
        {"ignored", report::ignored_json(c.ignored)},
        {"warnings", c.warnings()}});
    // clang-format on
}

std::string campaign_runs_csv(const CompareCampaign& c) {
    std::vector<report::TableColumn> columns = repeated_columns();
    columns.insert(columns.begin(), {"seed", ""});
    columns.insert(columns.end(), {{"nees_velocity", ""}, {"nees_attitude", ""}});
    report::ResultTable table = table_of_schemes(c.name, c.with_satellites(), columns);
    for (const SchemeCampaign& s : c.schemes) {
        for (std::size_t r = 0; r < c.seeds.size(); ++r) {
            std::vector<report::Cell>& row = table.rows.emplace_back(row_of_scheme(*s.scheme, s.satellites, {}));
            row.emplace_back(c.seeds[r]);
            row.insert(row.end(), s.numbers[r].begin(), s.numbers[r].end());
            row.resize(columns.size() - 2 + row_of_scheme(*s.scheme, s.satellites, {}).size());
            row.insert(row.end(), s.run_nees[r].begin() + 1, s.run_nees[r].end());
        }
    }
    return report::table_csv(table);
}

}  // namespace schuler::study
