// The forward filter compared with the one backward in time.
#include "schuler/core/units.h"
#include "schuler/report/detail/run_sections.h"

#include <array>
#include <cmath>

namespace schuler::report::detail {
namespace {

struct Line {
    const char *title, *label;
    Eigen::Vector3d ErrorPoint::*value;
    Eigen::Vector3d ErrorPoint::*sigma;
    int axis;
    double factor;  // to the unit and sign in the label
};
const std::array<Line, 4> lines{{
    {"North", "forward - backward, m", &ErrorPoint::position, &ErrorPoint::std_position, 0, 1.0},
    {"East", "forward - backward, m", &ErrorPoint::position, &ErrorPoint::std_position, 1, 1.0},
    {"Up", "forward - backward, m", &ErrorPoint::position, &ErrorPoint::std_position, 2, -1.0},
    {"Heading", "forward - backward, deg", &ErrorPoint::rpy, &ErrorPoint::std_rpy, 2, 1.0 / units::deg},
}};

}  // namespace

Section separation_section(const RunReportData& data) {
    Section section{
        "Forward/backward separation",
        "The forward filter minus one that runs over the same log backward in time and uses at each instant the other fixes; ±3σ of both "
        "together. What stays outside is a fault of an instrument, or of what is assumed about it.",
        {}};
    if (data.separation.empty()) return section;
    Group group;
    for (const Line& line : lines) {
        Panel panel = time_panel(data, line.title, line.label);
        panel.height = 220;
        Series difference{.name = "forward minus backward", .x = {}, .y = {}, .width = 1.6};
        Band band{.name = "±3σ", .x = {}, .lo = {}, .hi = {}};
        for (const ErrorPoint& p : data.separation) {
            const double sigma = 3.0 * std::abs(line.factor) * (p.*line.sigma)[line.axis];
            difference.x.push_back(axis_seconds(data, p.time));
            difference.y.push_back(line.factor * (p.*line.value)[line.axis]);
            band.lo.push_back(-sigma);
            band.hi.push_back(sigma);
        }
        band.x = difference.x;
        break_at_gaps(difference);
        break_at_gaps(band);
        panel.series.push_back(std::move(difference));
        panel.bands.push_back(std::move(band));
        group.panels.push_back(std::move(panel));
    }
    section.groups.push_back(std::move(group));
    return section;
}

}  // namespace schuler::report::detail
