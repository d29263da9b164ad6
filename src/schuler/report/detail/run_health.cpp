// The state of every source over time, one row each.
#include "schuler/report/detail/run_sections.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace schuler::report::detail {
namespace {

struct Look {
    const char* state;
    Ink ink;
};
constexpr std::array looks{Look{"used", Ink::Blue},         Look{"refused", Ink::Vermillion},
                           Look{"distrusted", Ink::Orange}, Look{"left out", Ink::Purple},
                           Look{"withheld", Ink::Muted},    Look{"hanging", Ink::Text},
                           Look{"silent", Ink::Sky},        Look{"partly refused", Ink::Vermillion},
                           Look{"partly used", Ink::Green}};

/// Thin if there were no data, or only a part was used.
double width_of(std::string_view state) { return state == "silent" ? 3.0 : state.starts_with("partly") ? 5.0 : 9.0; }

}  // namespace

Section health_section(const RunReportData& data) {
    Section section{
        "Health of the sources",
        "Used, refused by its gate, distrusted by the integrity monitor, left out before the run, withheld by the user, hanging (values that "
        "repeat), silent; partly refused, partly used: to and fro between these. Single refused samples among many used ones are not drawn.",
        {}};
    if (data.health.empty()) return section;
    std::vector<std::string> sources;
    for (const HealthEntry& h : data.health)
        if (std::ranges::find(sources, h.source) == sources.end()) sources.push_back(h.source);
    const double rows = static_cast<double>(sources.size());
    Panel panel = time_panel(data, "Sources", "");
    panel.y_limits = {-0.5, rows - 0.2};
    panel.height = static_cast<int>(70.0 + 36.0 * rows);
    for (std::size_t i = 0; i < sources.size(); ++i)
        panel.row_names.emplace_back(rows - 1.0 - static_cast<double>(i), sources[i]);
    for (const Look& look : looks) {
        Series bars{.name = look.state, .x = {}, .y = {}, .ink = look.ink, .width = width_of(look.state)};
        for (const HealthEntry& h : data.health) {
            if (h.state != look.state) continue;
            const double row = rows - 1.0 - static_cast<double>(std::ranges::find(sources, h.source) - sources.begin());
            bars.x.insert(bars.x.end(), {h.from_s, h.to_s, not_given});
            bars.y.insert(bars.y.end(), {row, row, not_given});
        }
        if (!bars.x.empty()) panel.series.push_back(std::move(bars));
    }
    section.groups.push_back({"", {std::move(panel)}, {}});
    return section;
}

}  // namespace schuler::report::detail
