#include "schuler/report/run_report.h"

#include "schuler/math/quantile.h"
#include "schuler/report/detail/run_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::report {
namespace detail {
namespace {

// Indices preceded by intervals of more than ten times the median.
std::vector<std::size_t> gaps(const std::vector<double>& t) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < t.size(); ++i) {
        if (std::isfinite(t[i] - t[i - 1])) steps.push_back(t[i] - t[i - 1]);
    }
    if (steps.size() < 2) return {};
    const double most = 10.0 * math::median(std::move(steps));
    std::vector<std::size_t> out;
    for (std::size_t i = 1; i < t.size(); ++i) {
        if (t[i] - t[i - 1] > most) out.push_back(i);
    }
    return out;
}

// v with NaN inserted before each of the (ascending) indices.
std::vector<double> with_gaps(const std::vector<double>& v, const std::vector<std::size_t>& places) {
    std::vector<double> out;
    out.reserve(v.size() + places.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
        if (next < places.size() && places[next] == i) {
            out.push_back(not_given);
            ++next;
        }
        out.push_back(v[i]);
    }
    return out;
}

}  // namespace

void break_at_gaps(Series& series) {
    const std::vector<std::size_t> places = gaps(series.time.empty() ? series.x : series.time);
    if (places.empty()) return;
    for (std::vector<double>* v : {&series.x, &series.y, &series.time}) *v = with_gaps(*v, places);
}

void break_at_gaps(Band& band) {
    const std::vector<std::size_t> places = gaps(band.x);
    if (places.empty()) return;
    for (std::vector<double>* v : {&band.x, &band.lo, &band.hi}) *v = with_gaps(*v, places);
}

Panel time_panel(const RunReportData& data, std::string title, std::string y_label, bool start_up) {
    Panel panel{.title = std::move(title), .x_label = time_label, .y_label = std::move(y_label)};
    // All over the same time, so that simultaneous events are aligned vertically.
    if (data.solution.size() > 1) {
        panel.x_limits = {axis_seconds(data, data.solution.front().time), axis_seconds(data, data.solution.back().time)};
    }
    if (start_up && data.settled_after_s > 0.0) {
        const double begin = panel.x_limits ? panel.x_limits->first : 0.0;
        if (begin < data.settled_after_s) panel.spans.push_back({begin, data.settled_after_s, "not counted", false});
    }
    for (std::size_t i = 0; i < data.outages.size(); ++i) {
        const OutageEntry& o = data.outages[i];
        panel.spans.push_back({o.start_s, o.start_s + o.duration_s, fmt::format("outage {}", i + 1), true});
    }
    return panel;
}

}  // namespace detail

namespace {

const AccuracyEntry* find_accuracy(const RunReportData& data, const std::string& quantity) {
    const auto it =
        std::find_if(data.accuracy.begin(), data.accuracy.end(), [&](const AccuracyEntry& a) { return a.quantity == quantity; });
    return it == data.accuracy.end() ? nullptr : &*it;
}

std::vector<Card> cards(const RunReportData& data) {
    std::vector<Card> out;
    if (!data.verdict.empty()) out.push_back({"Verdict", data.verdict, data.reasons.empty() ? "" : data.reasons.front()});
    if (!data.solution.empty()) {
        const double seconds = (data.solution.back().time - data.solution.front().time).seconds();
        out.push_back({"Duration", number(seconds, 5) + " s", fmt::format("{} epochs in the report", data.solution.size())});
    }
    constexpr std::array<std::pair<const char*, const char*>, 3> shown{
        {{"position horizontal", "Horizontal"}, {"position up", "Vertical"}, {"heading", "Heading"}}};
    for (const auto& [quantity, name] : shown) {
        const AccuracyEntry* a = find_accuracy(data, quantity);
        if (a == nullptr) continue;
        out.push_back({fmt::format("{} error, RMS", name), number(a->rms, 3) + " " + a->unit,
                       fmt::format("largest {} {}", number(a->max, 3), a->unit)});
    }
    std::size_t compared = 0, inside = 0;
    double square = 0.0;
    for (const OutageEntry& o : data.outages) {
        if (!o.compared || !std::isfinite(o.end_horizontal)) continue;
        ++compared;
        inside += o.inside_3sigma ? 1 : 0;
        // after smoothing the ends are tied to the fixes again, while the filter has its largest error there
        const double judged = data.smoothed ? o.max_horizontal : o.end_horizontal;
        square += judged * judged;
    }
    if (compared > 0) {
        out.push_back({data.smoothed ? "Largest horizontal in outages, RMS" : "Horizontal at outage ends, RMS",
                       number(std::sqrt(square / static_cast<double>(compared)), 3) + " m",
                       fmt::format("{} of {} inside 3σ throughout", inside, compared)});
    }
    out.insert(out.end(), data.cards.begin(), data.cards.end());
    return out;
}

Section findings_section(const RunReportData& data) {
    Section section{"Start-up", "What alignment and the estimators of settings found.", {}};
    if (data.findings.empty()) return section;
    TableBlock table{"", {"finding", "value"}, {}};
    for (const auto& [what, value] : data.findings) table.rows.push_back({what, value});
    section.groups.push_back({"", {}, {table}});
    return section;
}

}  // namespace

ReportInput run_report(const RunReportData& data) {
    ReportInput input{.title = data.title,
                      .subtitle = data.subtitle,
                      .cards = cards(data),
                      .sections = {},
                      .warnings = data.warnings,
                      .settings = data.settings,
                      .version = data.version};
    const auto add = [&input](Section section) {
        if (!section.groups.empty()) input.sections.push_back(std::move(section));
    };
    add(detail::track_section(data));
    add(detail::check_section(data));
    add(detail::health_section(data));
    add(detail::error_section(data));
    add(detail::separation_section(data));
    add(detail::outage_section(data));
    add(detail::uncertainty_section(data));
    add(detail::innovation_section(data));
    add(detail::sensor_section(data));
    add(detail::motion_section(data));
    add(findings_section(data));
    return input;
}

}  // namespace schuler::report
