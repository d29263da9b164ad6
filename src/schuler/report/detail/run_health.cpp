// The state of every source over time, a row each.
#include "schuler/report/detail/run_sections.h"

#include <algorithm>
#include <array>
#include <map>

namespace schuler::report::detail {
namespace {

struct Look {
    const char* state;
    Ink ink;
};
constexpr std::array looks{Look{"used", Ink::Blue},       Look{"refused", Ink::Vermillion}, Look{"distrusted", Ink::Orange}, Look{"left out", Ink::Purple},
                           Look{"withheld", Ink::Muted},  Look{"hanging", Ink::Text},       Look{"silent", Ink::Sky}};

/// Short enough for the margin of a plot.
std::string row_name(const std::string& source) {
    static const std::map<std::string, std::string> short_names{
        {"imu", "IMU"}, {"gnss_position", "position"}, {"gnss_velocity", "velocity"}, {"body_velocity", "log"}};
    const auto it = short_names.find(source);
    return it == short_names.end() ? source : it->second;
}

}  // namespace

Section health_section(const RunReportData& data) {
    Section section{"Health of the sources",
                    "Used, refused by its gate, distrusted by the integrity monitor, left out before the run, withheld by the user, hanging (values that "
                    "repeat), silent. Single refused samples are not drawn.",
                    {}};
    if (data.health.empty()) return section;
    std::vector<std::string> sources;
    for (const HealthEntry& h : data.health)
        if (std::ranges::find(sources, h.source) == sources.end()) sources.push_back(h.source);
    const double rows = static_cast<double>(sources.size());
    Panel panel = time_panel(data, "Sources", "source");
    panel.y_limits = {-0.6, rows - 0.4};
    panel.height = static_cast<int>(70.0 + 28.0 * rows);
    for (auto it = sources.rbegin(); it != sources.rend(); ++it) panel.y_names.push_back(row_name(*it));   // the first one on top
    for (const Look& look : looks) {
        Series bars{.name = look.state, .x = {}, .y = {}, .ink = look.ink, .width = std::string(look.state) == "silent" ? 3.0 : 9.0};
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
