// Trustworthiness of the solution, with the growth of errors and sigmas without fixes as evidence.
#include "schuler/report/detail/run_sections.h"

#include <array>

namespace schuler::report::detail {

Section check_section(const RunReportData& data) {
    Section section{"Verdict and self-check", data.check.intro, {}};
    if (data.verdict.empty()) return section;
    Group group;
    Panel growth{.title = "Growth without fixes",
                 .x_label = "time since the fixes were withheld, s",
                 .y_label = "horizontal, m, RMS",
                 .time_axis = false,
                 .height = 260};
    constexpr std::array<Ink, 2> inks{Ink::Blue, Ink::Orange};
    for (std::size_t i = 0; i < data.check.growth.size(); ++i) {
        const GrowthCurve& g = data.check.growth[i];
        const Ink ink = inks[i % inks.size()];
        growth.series.push_back({.name = "error" + g.name, .x = g.since_s, .y = g.error, .ink = ink, .width = 1.8});
        growth.series.push_back(
            {.name = "sigma" + g.name, .x = g.since_s, .y = g.sigma, .ink = ink, .mark = Mark::Dashed, .width = 1.8});
    }
    if (!growth.series.empty()) group.panels.push_back(std::move(growth));
    TableBlock reasons{"", {"verdict", "reason"}, {}};
    for (const std::string& reason : data.reasons) reasons.rows.push_back({reasons.rows.empty() ? data.verdict : "", reason});
    if (!reasons.rows.empty()) group.tables.push_back(std::move(reasons));
    for (const TableBlock& table : data.check.tables) group.tables.push_back(table);
    section.groups.push_back(std::move(group));
    return section;
}

}  // namespace schuler::report::detail
