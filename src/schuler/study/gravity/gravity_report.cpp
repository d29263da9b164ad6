#include "schuler/core/units.h"
#include "schuler/earth/enu.h"
#include "schuler/report/outputs.h"
#include "schuler/report/report.h"
#include "schuler/study/gravity/gravity.h"

#include <array>
#include <cmath>

namespace schuler::study {
namespace {

using Eigen::Vector3d;
using report::Ink;

using units::mgal;
constexpr std::array names{"east", "north", "up"};

/// Values of rows as a series.
template <class Pick>
std::vector<double> column(const std::vector<GravityRow>& rows, Pick pick) {
    std::vector<double> out;
    for (const GravityRow& r : rows) out.push_back(pick(r));
    return out;
}

std::vector<double> times(const std::vector<GravityRow>& rows) {
    return column(rows, [](const GravityRow& r) { return r.t; });
}

/// Estimate with three sigma, and the truth.
report::Panel component_panel(const std::vector<GravityRow>& rows, bool truth, int axis) {
    const auto value = [axis](const GravityRow& r) { return earth::enu_from_ned(r.disturbance_n)(axis) / mgal; };
    const auto sigma = [axis](const GravityRow& r) { return earth::sigma_swapped(r.sigma_n)(axis) / mgal; };
    report::Panel p{fmt::format("disturbance {}", names[static_cast<std::size_t>(axis)]), "time, s", "mGal"};
    const std::vector<double> t = times(rows);
    p.bands.push_back({"one sigma", t, column(rows, [&](const GravityRow& r) { return value(r) - sigma(r); }),
                       column(rows, [&](const GravityRow& r) { return value(r) + sigma(r); })});
    if (truth)
        p.series.push_back({"truth", t,
                            column(rows, [axis](const GravityRow& r) { return earth::enu_from_ned(r.truth_n)(axis) / mgal; }),
                            Ink::Text, report::Mark::Dashed});
    p.series.push_back({"estimate", t, column(rows, value)});
    return p;
}

/// Figure 3 of paper E: the estimate of the filter as it settles, compared with the truth.
report::Panel filter_panel(const GravityBundle& b) {
    report::Panel p{"vertical disturbance of the forward filter as it settles", "time, s", "mGal"};
    std::vector<double> t, estimate, truth, low, high;
    for (std::size_t i = 0; i < b.survey.forward.size(); ++i) {
        const gravimetry::SurveyEpoch& e = b.survey.forward[i];
        t.push_back(b.run.relative(e.time));
        estimate.push_back(-e.disturbance_n.z() / mgal);
        low.push_back(estimate.back() - e.sigma_disturbance_n.z() / mgal);
        high.push_back(estimate.back() + e.sigma_disturbance_n.z() / mgal);
        if (!b.truth.empty()) truth.push_back(-b.truth[i].z() / mgal);
    }
    p.bands.push_back({"one sigma", t, low, high});
    if (!truth.empty()) p.series.push_back({"truth", t, truth, Ink::Text, report::Mark::Dashed});
    p.series.push_back({"forward filter", t, estimate, Ink::Vermillion});
    return p;
}

/// Errors of the vertical disturbance, filter and smoother (figure 5 of paper E).
report::Panel error_panel(const GravityBundle& b) {
    report::Panel p{"error of the vertical disturbance", "time, s", "mGal"};
    std::vector<double> t, forward, smoothed, sigma, minus;
    const double settled = b.run.relative(b.run.evaluation.settled);
    for (std::size_t i = 0; i < b.survey.forward.size(); ++i) {
        t.push_back(b.run.relative(b.survey.forward[i].time));
        // The settling is shown in the previous panel.
        const double known = b.survey.forward[i].sigma_disturbance_n.z() / b.survey.forward.back().sigma_disturbance_n.z();
        const bool shown = t.back() >= settled && known < 3.0;
        forward.push_back(shown ? -(b.survey.forward[i].disturbance_n.z() - b.truth[i].z()) / mgal : not_given);
        if (!b.survey.smoothed.empty()) smoothed.push_back(-(b.survey.smoothed[i].disturbance_n.z() - b.truth[i].z()) / mgal);
        sigma.push_back(b.epochs()[i].sigma_disturbance_n.z() / mgal);
        minus.push_back(-sigma.back());
    }
    p.bands.push_back({"one sigma", t, minus, sigma});
    p.series.push_back({"forward filter", t, forward, Ink::Vermillion});
    std::vector<double> classical;
    // Its edges, where the low-pass has an incomplete window, would dominate the scale.
    for (std::size_t i = 0; i < b.classical.down.size(); ++i)
        classical.push_back(t[i] - t.front() < b.classical.period || t.back() - t[i] < b.classical.period
                                ? not_given
                                : -(b.classical.down[i] - b.truth[i].z()) / mgal);
    p.series.push_back({"classical", t, classical, Ink::Muted, report::Mark::Dashed, 1.0});
    if (!smoothed.empty()) p.series.push_back({"smoother", t, smoothed});
    return p;
}

/// Forward minus backward filter, with three sigma.
report::Group separation_group(const GravityBundle& b) {
    report::Group group{"Forward minus backward filter"};
    for (const int axis : {2, 0, 1}) {
        report::Panel p{fmt::format("separation {}", names[static_cast<std::size_t>(axis)]), "time, s", "mGal"};
        std::vector<double> t, value, low, high;
        for (const gravimetry::SurveySeparation& s : b.survey.separation) {
            if (s.time < b.run.evaluation.settled) continue;
            t.push_back(b.run.relative(s.time));
            value.push_back(earth::enu_from_ned(s.difference_n)(axis) / mgal);
            high.push_back(3.0 * earth::sigma_swapped(s.sigma_n)(axis) / mgal);
            low.push_back(-high.back());
        }
        p.bands.push_back({"±3σ", t, low, high});
        p.series.push_back({"forward minus backward", t, value});
        group.panels.push_back(std::move(p));
    }
    return group;
}

report::Group terms_group(const std::vector<GravityRow>& rows) {
    const std::vector<double> t = times(rows);
    report::Panel eotvos{"Eotvos term", "time, s", "mGal"}, vertical{"vertical acceleration of the vehicle", "time, s", "mGal"};
    eotvos.series.push_back({"", t, column(rows, [](const GravityRow& r) { return r.eotvos / mgal; })});
    vertical.series.push_back({"", t, column(rows, [](const GravityRow& r) { return r.vertical_acceleration / mgal; })});
    report::Group group{"What was taken off the accelerometers"};
    group.panels = {std::move(eotvos), std::move(vertical)};
    return group;
}

report::Panel profile_panel(const std::vector<GravityRow>& rows, bool truth) {
    report::Panel p{"gravity disturbance along the track", "distance, km", "mGal"};
    p.time_axis = false;
    const std::vector<double> x = column(rows, [](const GravityRow& r) { return 1e-3 * r.distance; });
    p.bands.push_back({"one sigma", x,
                       column(rows, [](const GravityRow& r) { return (r.disturbance_n.z() - r.sigma_n.z()) / mgal; }),
                       column(rows, [](const GravityRow& r) { return (r.disturbance_n.z() + r.sigma_n.z()) / mgal; })});
    if (truth)
        p.series.push_back({"truth", x, column(rows, [](const GravityRow& r) { return r.truth_n.z() / mgal; }), Ink::Text,
                            report::Mark::Dashed});
    p.series.push_back({"estimate", x, column(rows, [](const GravityRow& r) { return r.disturbance_n.z() / mgal; })});
    return p;
}

/// Crossovers before and after levelling, and the lines.
report::Group lines_group(const GravityBundle& b) {
    const GravityLines& l = b.lines;
    report::Group group{"Lines and crossovers"};
    report::TableBlock lines{"lines", {"line", "from, s", "to, s", "level, mGal"}, {}};
    for (std::size_t k = 0; k < l.lines.size(); ++k) {
        const auto at = [&](std::size_t i) { return report::number(b.run.relative(b.survey.forward[i].time), 6); };
        lines.rows.push_back(
            {fmt::format("{}", k + 1), at(l.lines[k].first), at(l.lines[k].last), report::number(l.lines[k].level / mgal, 3)});
    }
    report::TableBlock crossings{"crossovers, first line less second, mGal", {"lines", "before", "levelled"}, {}};
    for (const gravimetry::Crossover& c : l.crossings)
        crossings.rows.push_back({fmt::format("{} and {}", c.line_a + 1, c.line_b + 1),
                                  report::number((c.value_a - c.value_b) / mgal, 3),
                                  report::number(c.difference(l.lines) / mgal, 3)});
    if (!l.crossings.empty())
        crossings.rows.push_back({"rms", report::number(l.rms_before / mgal, 3), report::number(l.rms_after / mgal, 3)});
    group.tables = {std::move(lines)};
    if (!l.crossings.empty()) group.tables.push_back(std::move(crossings));
    if (!l.repeats.empty()) {
        report::TableBlock repeats{"repeated lines, mGal", {"lines", "length, km", "mean difference", "deviation"}, {}};
        for (const gravimetry::RepeatedLine& r : l.repeats)
            repeats.rows.push_back({fmt::format("{} and {}", r.line_a + 1, r.line_b + 1), report::number(1e-3 * r.length, 3),
                                    report::number(r.mean / mgal, 3), report::number(r.deviation / mgal, 3)});
        group.tables.push_back(std::move(repeats));
    }
    return group;
}

}  // namespace

std::string gravity_report_html(const GravityBundle& b, const std::vector<GravityRow>& rows) {
    report::ReportInput page = report::report_page(b.run);
    const bool truth = !b.truth.empty();
    page.subtitle = fmt::format("strapdown gravimetry, Earth-fixed frame, {}; {} IMU epochs at {:.4g} Hz, {} fixes",
                                b.survey.smoothed.empty() ? "forward filter" : "smoothed", b.run.result.counters.imu_epochs,
                                b.run.result.counters.imu_rate, b.run.result.counters.gnss_accepted);
    report::Section section{"Disturbance of gravity", b.attainable.statement + "."};
    if (b.attainable.usable) {
        const auto card = [](double x) { return fmt::format("{} mGal", report::number(x / mgal, 3)); };
        std::vector<report::Card> cards{
            {"vertical disturbance", card(-b.epochs().back().disturbance_n.z()), "at the end, up"},
            {"sigma", card(b.epochs().back().sigma_disturbance_n.z()), "of the vertical, at the end"}};
        if (truth) {
            cards.push_back({"error", card(b.errors.rms.z()), "vertical, RMS after settling"});
            cards.push_back({"error less its mean", card(b.errors.spread.z()), "what a crossover adjustment leaves"});
        }
        page.cards.insert(page.cards.begin(), cards.begin(), cards.end());
        report::Group estimate{"Estimate and truth"};
        for (const int axis : {2, 0, 1}) estimate.panels.push_back(component_panel(rows, truth, axis));
        if (rows.back().distance > 100.0) estimate.panels.push_back(profile_panel(rows, truth));
        section.groups.push_back(std::move(estimate));
        report::Group settling{"Filter and smoother"};
        settling.panels.push_back(filter_panel(b));
        if (truth) settling.panels.push_back(error_panel(b));
        section.groups.push_back(std::move(settling));
        if (b.separation.epochs > 0) section.groups.push_back(separation_group(b));
        section.groups.push_back(terms_group(rows));
        if (!b.lines.lines.empty()) section.groups.push_back(lines_group(b));
    }
    page.sections.insert(page.sections.begin(), std::move(section));
    return report::render(page);
}

}  // namespace schuler::study
