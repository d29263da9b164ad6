// Schemes over seeds as tables, as JSON and as CSV.
#include "schuler/report/inner/json.h"
#include "schuler/report/published.h"
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
constexpr std::string_view single_nees = "nees_position";  ///< of compared_columns: the ensemble's stands instead

/// Root mean square of a number over the runs that have it.
double rms_of(const std::vector<std::vector<double>>& runs, std::size_t i) {
    double sum = 0.0, n = 0.0;
    for (const std::vector<double>& numbers : runs) {
        if (i >= numbers.size() || !std::isfinite(numbers[i])) continue;
        sum += numbers[i] * numbers[i];
        n += 1.0;
    }
    return n > 0.0 ? std::sqrt(sum / n) : not_given;
}

/// Of a window over the runs: RMS of the RMS, largest of the largest, mean share, median recovery, and of a receiver.
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

/// A row a scheme under its number of satellites; `rest(scheme)` ends it.
template <class Rest>
std::string table_of(const CompareCampaign& c, const std::string& head, Rest rest) {
    std::string out = head;
    std::optional<std::size_t> satellites;
    for (const SchemeCampaign& s : c.schemes) {
        if (s.satellites != satellites) out += fmt::format("{} satellites\n", *s.satellites);
        satellites = s.satellites;
        out += fmt::format("  {:<34}{}\n", s.scheme->title, rest(s));
    }
    return out;
}

/// Columns that are repeated for the same seed, with their place among the numbers.
std::vector<std::pair<std::size_t, report::TableColumn>> counted_columns() {
    std::vector<std::pair<std::size_t, report::TableColumn>> out;
    const std::vector<report::TableColumn> all = repeated_columns();
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].key != single_nees) out.emplace_back(i, all[i]);
    return out;
}

}  // namespace

std::string campaign_tables(const CompareCampaign& c) {
    report::ResultTable settled{fmt::format("{}, {} runs each", c.name, c.seeds.size())};
    for (const auto& [i, column] : counted_columns()) settled.columns.push_back(column);
    for (const SchemeCampaign& s : c.schemes) {
        report::ResultRow& row = settled.rows.emplace_back(scheme_row(*s.scheme, s.satellites));
        for (const auto& [i, column] : counted_columns()) row.numbers.push_back(rms_of(s.numbers, i));
    }
    std::string out = report::table_text(settled);
    out += fmt::format("root mean squares over the runs, seeds {} to {}\n\n", c.seeds.front(), c.seeds.back());
    std::string head = fmt::format("{:<36}", "NEES, 3 expected (95 % bounds)");
    for (const char* title : {"position", "velocity", "attitude"}) head += fmt::format("{:>26}", title);
    out += table_of(c, head + "\n", [](const SchemeCampaign& s) {
        std::string row;
        for (const analysis::EnsembleConsistency& n : s.nees)
            row += std::isfinite(n.mean) ? fmt::format("{:>26}", fmt::format("{:.2f} ({:.2f} to {:.2f}) {}", n.mean, n.low95,
                                                                             n.high95, n.in_band() ? "  in" : "OUT"))
                                         : fmt::format("{:>26}", "-");
        if (!s.failures.empty()) row += fmt::format("   {} failed", s.failures.size());
        return row;
    });
    for (std::size_t k = 0; k < c.windows.size(); ++k) {
        report::ResultTable window{window_title(c.windows[k]), window_columns({})};
        for (const SchemeCampaign& s : c.schemes) {
            window.rows.push_back(scheme_row(*s.scheme, s.satellites));
            window.rows.back().numbers = window_of(s, k);
        }
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
            report::put_row(window, window_columns({}), window_of(s, k));
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
                        {"timing", {{"wall_s", c.wall_s}}}});
    // clang-format on
}

std::string campaign_runs_csv(const CompareCampaign& c) {
    report::ResultTable table{c.name, repeated_columns()};
    for (const SchemeCampaign& s : c.schemes) {
        for (std::size_t r = 0; r < c.seeds.size(); ++r) {
            report::ResultRow& row = table.rows.emplace_back(scheme_row(*s.scheme, s.satellites));
            row.labels.emplace_back("seed", fmt::format("{}", c.seeds[r]));
            row.numbers = s.numbers[r];
        }
    }
    return report::table_csv(table);
}

}  // namespace schuler::study
