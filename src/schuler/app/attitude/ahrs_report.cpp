#include "schuler/app/attitude/ahrs_outputs.h"
#include "schuler/core/units.h"
#include "schuler/math/rotation.h"
#include "schuler/report/report.h"

#include <cmath>

namespace schuler::app {
namespace {

/// Heading jumps from 360 to 0: drawn as a gap instead of a line across the plot.
void break_at_wraps(std::vector<double>& y) {
    for (std::size_t i = 1; i < y.size(); ++i) {
        if (std::abs(y[i] - y[i - 1]) > 180.0) y[i - 1] = not_given;
    }
}

report::Series of_reference(const AhrsBundle& b, int axis) {
    report::Series s{"reference", {}, {}, report::Ink::Muted, report::Mark::Dots};
    for (const ReferenceSample& r : b.data.recording.reference) {
        if (!r.rpy.allFinite()) continue;
        s.x.push_back((r.time - b.data.origin).seconds());
        s.y.push_back(r.rpy(axis) / units::deg);
    }
    return s;
}

report::Group attitude_panels(const AhrsBundle& b) {
    report::Group group{"Attitude"};
    const char* names[] = {"roll", "pitch", "heading"};
    std::vector<double> x;
    std::vector<Eigen::Vector3d> rpy;
    for (const ahrs::AttitudeRow& r : b.result.rows) {
        x.push_back((r.time - b.data.origin).seconds());
        rpy.push_back(math::rpy_from_quaternion(r.q_nb) / units::deg);
    }
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> y;
        for (const Eigen::Vector3d& v : rpy) y.push_back(v(axis));
        if (axis != 1) break_at_wraps(y);
        report::Panel panel{names[axis], "time, s", fmt::format("{}, deg", names[axis])};
        report::Series reference = of_reference(b, axis);
        if (!reference.x.empty()) panel.series.push_back(std::move(reference));
        panel.series.push_back({b.filter, x, std::move(y)});
        group.panels.push_back(std::move(panel));
    }
    return group;
}

report::Group error_panels(const AhrsBundle& b) {
    report::Group group{"Errors against the reference in movement"};
    report::Panel heading{"heading error, constant offset removed", "reference epoch", "deg"};
    report::Panel tilt{"inclination error", "reference epoch", "deg"};
    heading.time_axis = tilt.time_axis = false;
    report::Series h{"heading", {}, {}}, i{"inclination", {}, {}, report::Ink::Vermillion};
    const analysis::BroadErrors& e = b.evaluation.broad;
    for (std::size_t k = 0; k < e.headings.size(); ++k) {
        h.x.push_back(static_cast<double>(k));
        i.x.push_back(static_cast<double>(k));
        h.y.push_back(e.headings[k] / units::deg);
        i.y.push_back(e.inclinations[k] / units::deg);
    }
    heading.series.push_back(std::move(h));
    tilt.series.push_back(std::move(i));
    group.panels = {std::move(heading), std::move(tilt)};
    return group;
}

}  // namespace

std::string ahrs_report_html(const AhrsBundle& b) {
    report::ReportInput page;
    page.title = b.name;
    page.subtitle =
        fmt::format("attitude and heading: {}{}{}", b.filter, b.six_axis ? ", six axes" : "", b.offline ? ", offline" : "");
    page.version = b.version;
    page.warnings = b.warnings;
    page.settings = b.config_toml;
    report::Section section{"Attitude and heading", {}};
    section.groups.push_back(attitude_panels(b));
    const analysis::BroadErrors& e = b.evaluation.broad;
    if (e.epochs > 0) {
        page.cards = {{"total error", fmt::format("{} deg", report::number(e.total / units::deg, 3)),
                       "RMS in movement, constant heading offset removed"},
                      {"total error, raw", fmt::format("{} deg", report::number(e.raw_total / units::deg, 3)),
                       "RMS in movement, nothing removed"},
                      {"heading", fmt::format("{} deg", report::number(e.heading / units::deg, 3)), "constant offset taken off"},
                      {"inclination", fmt::format("{} deg", report::number(e.inclination / units::deg, 3)), "RMS"}};
        section.groups.push_back(error_panels(b));
    }
    page.sections.push_back(std::move(section));
    return report::render(page);
}

}  // namespace schuler::app
