// Paper D: satellites, ADS-B stations and INS in one filter.
#include "schuler/core/parallel.h"
#include "schuler/report/result_table.h"
#include "schuler/study/papers/item.h"
#include "schuler/study/triad/triad.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace schuler::study {
namespace {

struct PaperCase {
    TriadCase which;
    std::vector<TriadRun> runs{};
    TriadStatistics statistics{};
    double standard_error = 0.0;                  ///< of the pooled horizontal error over all runs, m
    std::vector<double> observed{}, predicted{};  ///< horizontal, root mean square over the runs, m
};

std::vector<PaperCase> run_cases(const PaperWork& w, const std::vector<std::string_view>& wanted) {
    std::vector<PaperCase> out;
    for (const TriadCase& c : triad_cases())
        if (std::ranges::find(wanted, std::string_view(c.name)) != wanted.end()) out.push_back({.which = c});
    for (std::size_t k = 0; k < out.size(); ++k) {
        std::vector<TriadRun>& runs = out[k].runs;
        runs.resize(w.runs);
        for_each_run(
            w.runs, w.jobs,
            [&](std::size_t j) { runs[j] = run_triad(out[k].which, j % triad_geometries, w.seed + j / triad_geometries); },
            [&](double share) {
                if (w.progress) w.progress((static_cast<double>(k) + share) / static_cast<double>(out.size()));
            });
        out[k].statistics = statistics_of(runs);
        const double sets = std::max(1.0, static_cast<double>(w.runs) / static_cast<double>(triad_geometries));
        out[k].standard_error = standard_error_of_a_set(runs) / std::sqrt(sets);
        for (std::size_t i = 0; i < triad_epochs; ++i) {
            double square = 0.0, variance = 0.0;
            for (const TriadRun& r : runs) {
                square += r.horizontal[i] * r.horizontal[i];
                variance += r.predicted_horizontal[i] * r.predicted_horizontal[i];
            }
            out[k].observed.push_back(std::sqrt(square / static_cast<double>(runs.size())));
            out[k].predicted.push_back(std::sqrt(variance / static_cast<double>(runs.size())));
        }
    }
    return out;
}

PaperResult result_of(const std::vector<PaperCase>& cases) {
    PaperResult out;
    // clang-format off
    report::ResultTable table{"", {{"case", "case"}, {"pooled_m", "horizontal", "m"}, {"predicted_m", "predicted", "m"},
                                   {"two_sigma_3d_m", "2 sigma 3-d", "m"}, {"vertical_m", "vertical", "m"}, {"at_300_s_m", "at 300 s", "m"},
                                   {"at_600_s_m", "at 600 s", "m"}, {"nees_position", "NEES/3"}, {"nees_nine", "NEES/9"}}};
    // clang-format on
    std::vector<double> t(triad_epochs);
    for (std::size_t i = 0; i < triad_epochs; ++i) t[i] = static_cast<double>(i);
    for (const PaperCase& c : cases) {
        const TriadStatistics& s = c.statistics;
        table.rows.push_back({c.which.name, s.pooled, s.predicted, s.two_sigma, s.vertical, s.at_300, s.end, s.nees3, s.nees9});
        report::Panel panel{c.which.name, "time after the loss, s", "horizontal error, m"};
        panel.series = {paper_curve("root mean square over the runs", t, c.observed),
                        paper_curve("one sigma of the filter", t, c.predicted, report::Ink::Vermillion, report::Mark::Dashed)};
        out.panels.push_back(std::move(panel));
    }
    out.tables.push_back(std::move(table));
    out.notes = "Geometries, instruments and clocks are those of math.md 5.4; the paper states none of them.\n";
    return out;
}

/// Statistics of the same runs, of every case.
std::vector<TriadStatistics> statistics_of_runs(const std::vector<PaperCase>& cases, const std::vector<std::size_t>& which) {
    std::vector<TriadStatistics> out;
    for (const PaperCase& c : cases) {
        std::vector<const TriadRun*> runs;
        for (const std::size_t i : which) runs.push_back(&c.runs[i]);
        out.push_back(statistics_of(runs));
    }
    return out;
}
/// Numbers and their scatter from the statistics of the cases.
PaperResult result_of(
    const PaperWork& w, const std::vector<PaperCase>& cases,
    const std::function<std::vector<std::pair<std::string, double>>(const std::vector<TriadStatistics>&)>& numbers) {
    PaperResult out = result_of(cases);
    set_numbers(out, w.runs, [&](const std::vector<std::size_t>& which) { return numbers(statistics_of_runs(cases, which)); });
    return out;
}

using Cases = const std::vector<TriadStatistics>&;
using Numbers = std::vector<std::pair<std::string, double>>;

PaperResult figure_2(const PaperWork& w) {
    return result_of(w, run_cases(w, {"a 4 SV nav", "a 4 SV tac"}), [](Cases s) { return Numbers{{"2 sigma", s[0].two_sigma}}; });
}

PaperResult figure_3(const PaperWork& w) {
    return result_of(w, run_cases(w, {"b 3 SV nav", "b 3 SV tac", "b 3 SV nav no baro", "c 2 SV nav"}), [](Cases s) {
        return Numbers{{"3 SV", s[0].two_sigma}, {"3 SV no baro", s[2].two_sigma}, {"2 SV", s[3].two_sigma / s[0].two_sigma}};
    });
}

PaperResult figure_4(const PaperWork& w) {
    return result_of(w, run_cases(w, {"c 2 SV nav", "d 4 stations nav"}), [](Cases s) {
        return Numbers{{"horizontal", s[1].pooled / s[0].pooled}};
    });
}

PaperResult figure_5(const PaperWork& w) {
    PaperResult out = result_of(w, run_cases(w, {"c 2 SV nav", "e 2 SV+2 st. nav", "e stations on at 300 s nav"}), [](Cases s) {
        return Numbers{{"before", 2.0 * s[2].at_300},
                       {"after", 2.0 * s[2].end},
                       {"ratio", s[2].at_300 / s[2].at_330},
                       {"conclusion", 2.0 * s[1].end}};
    });
    out.panels.back().spans.push_back({300.0, 600.0, "two stations more", false});
    return out;
}

/// The error of every arrangement over the filter's own prediction, navigation grade.
PaperResult prediction(const PaperWork& w) {
    // clang-format off
    constexpr std::array<std::pair<std::string_view, const char*>, 6> keys{{{"a 4 SV nav", "4 SV"}, {"b 3 SV nav", "3 SV"}, {"c 2 SV nav", "2 SV"},
        {"d 4 stations nav", "4 stations"}, {"e 2 SV+2 st. nav", "2 SV + 2 stations"}, {"e stations on at 300 s nav", "stations at 300 s"}}};
    // clang-format on
    std::vector<std::string_view> names;
    for (const auto& [name, key] : keys) names.push_back(name);
    const std::vector<PaperCase> cases = run_cases(w, names);
    PaperResult out = result_of(cases);
    report::ResultTable table{
        "horizontal error over its prediction, and the standard error of this ratio for this number of runs",
        {{"case", "case"}, {"ratio", "ratio", "", ".3f"}, {"standard_error", "standard error", "", ".3f"}}};
    for (const PaperCase& c : cases) {
        const double ratio = c.statistics.pooled / c.statistics.predicted;
        const auto key = std::ranges::find(keys, std::string_view(c.which.name), &decltype(keys)::value_type::first);
        out.numbers.emplace_back(key->second, ratio);
        table.rows.push_back({c.which.name, ratio, c.standard_error / c.statistics.predicted});
    }
    out.tables.push_back(std::move(table));
    return out;
}

}  // namespace

std::vector<PaperItem> paper_d_items() {
    return {{"D", "figure-2", "four satellites", 48, 0.07, figure_2},
            {"D", "figure-3", "three and two satellites", 48, 0.14, figure_3},
            {"D", "figure-4", "four stations instead of satellites", 48, 0.07, figure_4},
            {"D", "figure-5", "two satellites, and two stations with them", 48, 0.1, figure_5},
            {"D", "prediction", "errors of figures 2 to 5 within 5 % of the filter's prediction", 1152, 0.21, prediction}};
}

}  // namespace schuler::study
