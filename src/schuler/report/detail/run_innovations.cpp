// Innovations inside their gates and their normalised squares against chi-square bounds.
#include "schuler/math/chi_square.h"
#include "schuler/report/detail/run_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>

namespace schuler::report::detail {
namespace {

// One curve for each status; append_filled omits those without points.
std::array<Series, 3> status_series() {
    return {{{.name = "accepted", .x = {}, .y = {}, .ink = Ink::Blue, .mark = Mark::Dots, .clamp = true},
             {.name = "rejected", .x = {}, .y = {}, .ink = Ink::Vermillion, .mark = Mark::Squares, .clamp = true},
             {.name = "withheld", .x = {}, .y = {}, .ink = Ink::Purple, .mark = Mark::Dots, .clamp = true}}};
}

void append_filled(Panel& panel, std::array<Series, 3>& series) {
    for (const std::size_t k : {0U, 2U, 1U}) {  // rejected ones on top
        if (!series[k].x.empty()) panel.series.push_back(std::move(series[k]));
    }
}

// The value below which the given fraction of v lies; 0 without values.
double percentile(std::vector<double> v, double share) {
    if (v.empty()) return 0.0;
    const auto place = v.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(v.size() - 1));
    std::nth_element(v.begin(), place, v.end());
    return *place;
}

// A component's panel over the whole range and, if a few large values (start-up, outages and the time after them, outliers) would
// flatten the rest, an additional one at the scale of the rest. Empty if the component is never measured.
struct InnovationPanels {
    std::optional<Panel> whole, enlarged;
};

InnovationPanels innovation_panels(const RunReportData& data, const InnovationGroup& group, int component) {
    constexpr double much_larger = 6.0;
    const std::string& name = group.components[static_cast<std::size_t>(component)];
    Panel panel = time_panel(data, fmt::format("{} innovation, {}", group.name, name), fmt::format("innovation, {}", group.unit));
    std::array<Series, 3> series = status_series();
    Band band{.name = "±3σ predicted", .x = {}, .lo = {}, .hi = {}};
    std::vector<double> gates, used;  // of the epochs not withheld
    double largest = 0.0;
    for (const InnovationPoint& p : group.points) {
        const double t = axis_seconds(data, p.time), v = p.innovation[component] / group.unit_si;
        const double s = 3.0 * p.sigma[component] / group.unit_si;
        if (!std::isfinite(v)) continue;
        Series& one = series[static_cast<std::size_t>(p.status)];
        one.x.push_back(t);
        one.y.push_back(v);
        band.x.push_back(t);
        band.lo.push_back(-s);
        band.hi.push_back(s);
        largest = std::fmax(largest, std::abs(v));
        if (p.status != InnovationStatus::Withheld && std::isfinite(s)) gates.push_back(s);
        if (p.status == InnovationStatus::Accepted) used.push_back(std::abs(v));
    }
    if (band.x.empty()) return {};
    const double reach = 1.25 * std::fmax(percentile(gates, 0.95), percentile(used, 0.99));
    break_at_gaps(band);
    panel.bands.push_back(std::move(band));
    append_filled(panel, series);
    InnovationPanels out{panel, std::nullopt};
    for (Series& s : out.whole->series) s.clamp = false;
    if (reach > 0.0 && largest > much_larger * reach) {
        out.enlarged = std::move(panel);
        out.enlarged->title += ", enlarged: scale of the accepted ones";
        out.enlarged->y_limits = {-reach, reach};
    }
    return out;
}

// Two-sided 95 % bounds for each number of degrees of freedom present: constant bands over all the time.
std::vector<Band> chi_square_bands(const RunReportData& data, const InnovationGroup& group) {
    constexpr std::array<Ink, 3> inks{Ink::Green, Ink::Orange, Ink::Sky};
    const Panel time = time_panel(data, "", "");
    std::set<int> dofs;
    double first = axis_seconds(data, group.points.front().time), last = first;
    for (const InnovationPoint& p : group.points) {
        if (p.dof > 0 && std::isfinite(p.nis)) dofs.insert(p.dof);
        first = std::fmin(first, axis_seconds(data, p.time));
        last = std::fmax(last, axis_seconds(data, p.time));
    }
    if (time.x_limits) std::tie(first, last) = *time.x_limits;
    std::vector<Band> bands;
    for (const int dof : dofs) {
        const double low = math::chi_square_quantile(0.025, dof), high = math::chi_square_quantile(0.975, dof);
        bands.push_back({.name = fmt::format("95 % of χ², {} dof", dof),
                         .x = {first, last},
                         .lo = {low, low},
                         .hi = {high, high},
                         .ink = inks[bands.size() % inks.size()]});
    }
    return bands;
}

Panel nis_panel(const RunReportData& data, const InnovationGroup& group) {
    Panel panel = time_panel(data, fmt::format("{}, normalised innovation squared", group.name), "NIS");
    panel.log_y = true;
    panel.bands = chi_square_bands(data, group);
    std::array<Series, 3> series = status_series();
    double top = 20.0;
    for (const InnovationPoint& p : group.points) {
        if (!std::isfinite(p.nis) || p.dof < 1) continue;
        Series& one = series[static_cast<std::size_t>(p.status)];
        one.x.push_back(axis_seconds(data, p.time));
        one.y.push_back(p.nis);
        top = std::fmax(top, p.nis);
    }
    panel.y_limits = {1e-3, std::fmin(1.5 * top, 1e3)};
    append_filled(panel, series);
    return panel;
}

std::vector<std::string> summary_row(const InnovationGroup& group) {
    std::array<std::size_t, 3> count{};
    double nis = 0.0, dof = 0.0;
    std::size_t above = 0, counted = 0;
    for (const InnovationPoint& p : group.points) {
        ++count[static_cast<std::size_t>(p.status)];
        if (p.status != InnovationStatus::Accepted || !std::isfinite(p.nis) || p.dof < 1) continue;
        ++counted;
        nis += p.nis;
        dof += p.dof;
        above += math::chi_square_survival(p.nis, p.dof) < 0.05 ? 1 : 0;
    }
    const double n = counted > 0 ? static_cast<double>(counted) : not_given;
    return {group.name,
            fmt::format("{}", count[0]),
            fmt::format("{}", count[1]),
            fmt::format("{}", count[2]),
            number(nis / n, 3),
            number(dof / n, 3),
            number(nis / dof, 3),
            number(100.0 * static_cast<double>(above) / n, 3),
            number(group.lag1, 2)};
}

}  // namespace

Section innovation_section(const RunReportData& data) {
    Section section{"Innovations", "", {}};
    TableBlock table{"Consistency of accepted innovations",
                     {"measurement", "accepted", "rejected", "withheld", "mean NIS", "mean dof", "NIS/dof (1)",
                      "above 95 % bound, % (5)", "lag-1 correlation (0)"},
                     {}};
    for (const InnovationGroup& group : data.innovations) {
        if (group.points.empty()) continue;
        Group out{group.name, {}, {}};
        const int components = std::min(3, static_cast<int>(group.components.size()));
        std::vector<Panel> enlarged;
        for (int c = 0; c < components; ++c) {
            InnovationPanels panels = innovation_panels(data, group, c);
            if (panels.whole) out.panels.push_back(std::move(*panels.whole));
            if (panels.enlarged) enlarged.push_back(std::move(*panels.enlarged));
        }
        out.panels.insert(out.panels.end(), enlarged.begin(), enlarged.end());
        out.panels.push_back(nis_panel(data, group));
        section.groups.push_back(std::move(out));
        table.rows.push_back(summary_row(group));
    }
    if (section.groups.empty()) return section;
    section.intro =
        "Estimate minus measurement before its own update, in the forward pass, with the predicted three sigma. In an "
        "enlarged plot, values beyond it are drawn at its edge. The expected value of a consistent filter is in brackets.";
    section.groups.insert(section.groups.begin(), Group{"", {}, {table}});
    return section;
}

}  // namespace schuler::report::detail
