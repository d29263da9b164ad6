// Paper D: satellites, ADS-B stations and INS in one filter.
#include "schuler/core/parallel.h"
#include "schuler/report/result_table.h"
#include "schuler/study/papers/item.h"
#include "schuler/study/triad/triad.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace schuler::study {
namespace {

struct PaperCase {
    TriadCase which;
    TriadStatistics statistics;
    std::vector<double> observed, predicted;  ///< horizontal, root mean square over the runs, m
};

std::vector<PaperCase> run_cases(const PaperWork& w, const std::vector<std::string_view>& wanted) {
    std::vector<PaperCase> out;
    for (const TriadCase& c : triad_cases())
        if (std::ranges::find(wanted, std::string_view(c.name)) != wanted.end()) out.push_back({c, {}, {}, {}});
    for (std::size_t k = 0; k < out.size(); ++k) {
        std::vector<TriadRun> runs(w.runs);
        for_each_run(
            w.runs, w.jobs,
            [&](std::size_t j) { runs[j] = run_triad(out[k].which, j % triad_geometries, w.seed + j / triad_geometries); },
            [&](double share) {
                if (w.progress) w.progress((static_cast<double>(k) + share) / static_cast<double>(out.size()));
            });
        out[k].statistics = statistics_of(runs);
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

PaperResult figure_2(const PaperWork& w) {
    const std::vector<PaperCase> c = run_cases(w, {"a 4 SV nav", "a 4 SV tac"});
    PaperResult out = result_of(c);
    out.numbers = {{"2 sigma", c[0].statistics.two_sigma}};
    return out;
}

PaperResult figure_3(const PaperWork& w) {
    const std::vector<PaperCase> c = run_cases(w, {"b 3 SV nav", "b 3 SV tac", "b 3 SV nav no baro", "c 2 SV nav"});
    PaperResult out = result_of(c);
    out.numbers = {{"3 SV", c[0].statistics.two_sigma},
                   {"3 SV no baro", c[2].statistics.two_sigma},
                   {"2 SV", c[3].statistics.two_sigma / c[0].statistics.two_sigma}};
    return out;
}

PaperResult figure_4(const PaperWork& w) {
    const std::vector<PaperCase> c = run_cases(w, {"c 2 SV nav", "d 4 stations nav"});
    PaperResult out = result_of(c);
    out.numbers = {{"horizontal", c[1].statistics.pooled / c[0].statistics.pooled}};
    return out;
}

PaperResult figure_5(const PaperWork& w) {
    const std::vector<PaperCase> c = run_cases(w, {"c 2 SV nav", "e 2 SV+2 st. nav", "e stations on at 300 s nav"});
    PaperResult out = result_of(c);
    const TriadStatistics& on = c[2].statistics;
    out.numbers = {{"before", 2.0 * on.at_300},
                   {"after", 2.0 * on.end},
                   {"ratio", on.at_300 / on.at_330},
                   {"conclusion", 2.0 * c[1].statistics.end}};
    out.panels.back().spans.push_back({300.0, 600.0, "two stations more", false});
    return out;
}

}  // namespace

std::vector<PaperItem> paper_d_items() {
    return {{"D", "figure-2", "four satellites", 48, 0.07, figure_2},
            {"D", "figure-3", "three and two satellites", 48, 0.14, figure_3},
            {"D", "figure-4", "four stations instead of satellites", 48, 0.07, figure_4},
            {"D", "figure-5", "two satellites, and two stations with them", 48, 0.1, figure_5}};
}

}  // namespace schuler::study
