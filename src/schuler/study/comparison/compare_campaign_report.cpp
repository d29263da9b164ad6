// Schemes over seeds as a page: the errors of each over time, and its stated sigmas.
#include "schuler/core/units.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/study/comparison/compare.h"
#include "schuler/study/comparison/compare_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::study {
namespace {

/// A quantity for the schemes with this number of satellites: RMS as a line, sigma dashed in the same colour.
report::Panel panel_of(const CompareCampaign& c, std::optional<std::size_t> satellites, std::size_t quantity, const char* title,
                       const char* unit, double scale) {
    constexpr std::array inks{report::Ink::Blue,   report::Ink::Vermillion, report::Ink::Green, report::Ink::Purple,
                              report::Ink::Orange, report::Ink::Sky,        report::Ink::Text};
    report::Panel panel{title, "time, s", unit};
    panel.log_y = true;
    panel.height = 320;
    panel.x_limits = {0.0, c.duration};
    for (const settings::CompareWindow& w : c.windows) panel.spans.push_back({w.start, w.end, w.name, false});
    for (const settings::OutageSpan& o : c.outages) panel.spans.push_back({o.start, o.start + o.duration, "outage", true});
    std::ranges::stable_sort(panel.spans, {}, &report::Span::start);
    std::size_t drawn = 0;
    for (const SchemeCampaign& s : c.schemes) {
        if (s.satellites != satellites) continue;
        report::Series rms{s.scheme->title, {}, {}, inks[drawn % inks.size()]};
        report::Series sigma{
            fmt::format("{}, stated", s.scheme->title), {}, {}, inks[drawn % inks.size()], report::Mark::Dashed, 1.0};
        ++drawn;
        for (std::size_t k = 0; k < SquaredCourse::spans; ++k) {
            const double n = s.course.count[quantity][k], t = (static_cast<double>(k) + 0.5) * c.duration / SquaredCourse::spans;
            rms.x.push_back(t);
            sigma.x.push_back(t);
            rms.y.push_back(n > 0.0 ? scale * std::sqrt(s.course.square[quantity][k] / n) : not_given);
            sigma.y.push_back(n > 0.0 ? scale * std::sqrt(s.course.variance[quantity][k] / n) : not_given);
        }
        panel.series.push_back(std::move(rms));
        panel.series.push_back(std::move(sigma));
    }
    return panel;
}

}  // namespace

void SquaredCourse::add(const std::vector<analysis::ErrorRow>& rows, Time origin, double duration) {
    for (const analysis::ErrorRow& e : rows) {
        const double t = (e.time - origin).seconds();
        if (!(t >= 0.0 && duration > 0.0)) continue;
        const std::size_t k = std::min(spans - 1, static_cast<std::size_t>(t / duration * static_cast<double>(spans)));
        const std::array<std::pair<double, double>, quantities> both{{
            {e.position.head<2>().squaredNorm(), e.std_position.head<2>().squaredNorm()},
            {e.position.z() * e.position.z(), e.std_position.z() * e.std_position.z()},
            {e.velocity.squaredNorm(), e.std_velocity.squaredNorm()},
            {e.rpy.z() * e.rpy.z(), e.std_rpy.z() * e.std_rpy.z()},
        }};
        for (std::size_t q = 0; q < quantities; ++q) {
            if (!std::isfinite(both[q].first) || !std::isfinite(both[q].second)) continue;
            square[q][k] += both[q].first;
            variance[q][k] += both[q].second;
            count[q][k] += 1.0;
        }
    }
}

void SquaredCourse::add(const SquaredCourse& other) {
    for (std::size_t q = 0; q < quantities; ++q)
        for (std::size_t k = 0; k < spans; ++k) {
            square[q][k] += other.square[q][k];
            variance[q][k] += other.variance[q][k];
            count[q][k] += other.count[q][k];
        }
}

report::ReportInput campaign_report(const CompareCampaign& c) {
    report::ReportInput page{
        c.name, fmt::format("{} runs of each scheme, seeds {} to {}", c.seeds.size(), c.seeds.front(), c.seeds.back())};
    page.version = c.version;
    page.settings = c.settings;
    report::Section honesty{"Consistency", "Of all errors after settling, against the covariances that the filters stated."};
    honesty.groups.push_back({"", {}, {report::table_block(nees_table(c))}});
    report::Section courses{"Errors over time",
                            "Root mean square over the runs, and dashed the sigma that the solutions stated: "
                            "where a scheme is consistent the two coincide."};
    for (const std::optional<std::size_t>& satellites : counts_of_satellites(c.schemes)) {
        report::Group& group = courses.groups.emplace_back();
        if (satellites) group.title = fmt::format("{} satellites", *satellites);
        group.panels = {panel_of(c, satellites, 0, "horizontal error", "m", 1.0),
                        panel_of(c, satellites, 1, "height error", "m", 1.0),
                        panel_of(c, satellites, 2, "velocity error", "m/s", 1.0),
                        panel_of(c, satellites, 3, "heading error", "deg", 1.0 / units::deg)};
    }
    page.sections.push_back(std::move(honesty));
    page.sections.push_back(std::move(courses));
    return page;
}

}  // namespace schuler::study
