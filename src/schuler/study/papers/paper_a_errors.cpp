// Paper A, sections 1.4 and 4.1: errors of an INS at rest.
#include "schuler/core/units.h"
#include "schuler/report/result_table.h"
#include "schuler/study/papers/item.h"
#include "schuler/theory/modes.h"
#include "schuler/theory/requirements.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::study {
namespace {

using namespace theory;

LevelFlight at_kyiv() {
    LevelFlight f;
    f.position = {50.45 * units::deg, 30.0 * units::deg, 0.0};
    f.vertical = VerticalChannel::Fixed;
    return f;
}
Vector9 with(LevelError which, double size) {
    Vector9 x = Vector9::Zero();
    x(which) = size;
    return x;
}
ConstantErrors gyro(LevelError axis, double deg_h) {
    ConstantErrors c;
    c.gyro(axis - a_e) = deg_h * units::deg_per_hour;
    return c;
}

struct Followed {
    std::vector<double> minutes, east, north, distance;
    double largest = 0.0, at = 0.0;  ///< m, min
};
Followed followed(const Vector9& x, const ConstantErrors& c, double seconds) {
    Followed out;
    for (const ErrorsAt& e : LevelAnalysis(at_kyiv(), x, c).history(seconds, 2000)) {
        out.minutes.push_back(e.t / 60.0);
        out.east.push_back(e.errors(0));
        out.north.push_back(e.errors(1));
        out.distance.push_back(e.errors.head<2>().norm());
        if (out.distance.back() > out.largest) {
            out.largest = out.distance.back();
            out.at = e.t / 60.0;
        }
    }
    return out;
}

report::Panel panel_of(const std::string& title, const Followed& f) {
    report::Panel p{title, "time, min", "m"};
    p.time_axis = false;
    p.height = 260;
    p.series = {paper_curve("east", f.minutes, f.east), paper_curve("north", f.minutes, f.north, report::Ink::Green),
                paper_curve("distance", f.minutes, f.distance, report::Ink::Muted, report::Mark::Dashed)};
    return p;
}
/// Period of the pendulum, min.
double period() { return 2.0 * std::numbers::pi / Pendulum{}.frequency() / 60.0; }
double end_of(const ConstantErrors& c, double seconds) { return followed(Vector9::Zero(), c, seconds).distance.back(); }

PaperResult figure_411(const PaperWork&) {
    const Followed f = followed(with(a_e, 1e-3), {}, 4.0 * 5064.0);
    const Followed first = followed(with(a_e, 1e-3), {}, 5064.0);
    PaperResult out;
    out.numbers = {{"largest", first.largest}, {"time", first.at}, {"period", period()}};
    out.panels = {panel_of("tilt 1e-3 rad about east", f)};
    out.notes = fmt::format("A pendulum swings by 2 R alpha = {:.0f} m; the whole model at latitude 50.45 deg by {:.0f} m.\n",
                            Pendulum{}.from_tilt(1e-3, 30.0 * period()), first.largest);
    return out;
}

PaperResult figure_412(const PaperWork&) {
    const Followed f = followed(Vector9::Zero(), gyro(a_n, 0.01), 4.0 * 5064.0),
                   up = followed(Vector9::Zero(), gyro(a_u, 0.01), 4.0 * 5064.0);
    PaperResult out;
    out.numbers = {{"vertical", end_of(gyro(a_u, 0.01), 3600.0)},
                   {"horizontal", end_of(gyro(a_n, 0.01), 3600.0)},
                   {"10 min", end_of(gyro(a_n, 0.961), 600.0)},
                   {"1 min", end_of(gyro(a_n, 876.6), 60.0)}};
    out.panels = {panel_of("north gyro 0.01 deg/h", f), panel_of("vertical gyro 0.01 deg/h", up)};
    return out;
}

PaperResult figure_413(const PaperWork&) {
    const Followed f = followed(with(d_ve, 1.0), {}, 4.0 * 5064.0);
    std::vector<double> crossings;
    for (std::size_t i = 1; i < f.east.size(); ++i)
        if (f.east[i - 1] < 0.0 && f.east[i] >= 0.0)
            crossings.push_back(f.minutes[i - 1] -
                                f.east[i - 1] * (f.minutes[i] - f.minutes[i - 1]) / (f.east[i] - f.east[i - 1]));
    PaperResult out;
    const double mean =
        crossings.size() > 1 ? (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1) : std::nan("");
    out.numbers = {{"period", mean}};
    out.panels = {panel_of("velocity 1 m/s east", f)};
    out.notes = fmt::format("Bounded: {:.0f} m at the most (a pendulum: 1/w = {:.0f} m); its plane turns as Foucault's does.\n",
                            f.largest, 1.0 / Pendulum{}.frequency());
    return out;
}

PaperResult figure_414(const PaperWork&) {
    ConstantErrors accel;
    accel.accel.x() = 1e-4 * Pendulum{}.g;
    const double hours = 6.0 * 3600.0;
    const Followed tilt = followed(with(a_n, -1e-3), {}, hours), drift = followed(Vector9::Zero(), gyro(a_n, 0.01), hours),
                   bias = followed(Vector9::Zero(), accel, hours);
    ConstantErrors both = gyro(a_n, 0.01);
    both.accel = accel.accel;
    const Followed sum = followed(with(a_n, -1e-3), both, hours);
    const Followed first = followed(Vector9::Zero(), accel, 5064.0);
    const auto at = [](const Followed& f, double minutes) {
        double largest = 0.0;  // largest value in the Schuler period before
        for (std::size_t i = 0; i < f.minutes.size(); ++i)
            if (f.minutes[i] <= minutes && f.minutes[i] > minutes - 84.4) largest = std::max(largest, f.distance[i]);
        return largest;
    };
    PaperResult out;
    out.numbers = {{"accelerometer", first.largest}, {"gyro over accelerometer", at(drift, 240.0) / at(bias, 240.0)}};
    report::Panel p{"error east", "time, min", "m"};
    p.time_axis = false;
    p.height = 300;
    p.series = {paper_curve("tilt 1e-3 rad", tilt.minutes, tilt.east, report::Ink::Blue),
                paper_curve("gyro 0.01 deg/h", drift.minutes, drift.east, report::Ink::Vermillion),
                paper_curve("accelerometer 1e-4 g", bias.minutes, bias.east, report::Ink::Green),
                paper_curve("together", sum.minutes, sum.east, report::Ink::Text, report::Mark::Dashed)};
    out.panels = {std::move(p)};
    report::ResultTable table{"largest distance",
                              {{"source", "source of the error"}, {"hour_1", "in 1 h", "m"}, {"hour_6", "in 6 h", "m"}}};
    for (const auto& [name, f] : {std::pair{"tilt 1e-3 rad", &tilt}, std::pair{"gyro 0.01 deg/h", &drift},
                                  std::pair{"accelerometer 1e-4 g", &bias}, std::pair{"together", &sum}}) {
        double one = 0.0;
        for (std::size_t i = 0; i < f->minutes.size() && f->minutes[i] <= 60.0; ++i) one = std::max(one, f->distance[i]);
        table.rows.push_back({name, one, f->largest});
    }
    out.tables.push_back(std::move(table));
    return out;
}

constexpr double budget_m = 5.0;

/// The outages of figures 1.4.1 and 1.4.2: 10 s to an hour.
std::vector<double> outages_of_the_figures() {
    std::vector<double> out;
    for (int i = 0; i <= 200; ++i) out.push_back(10.0 * std::pow(3600.0 / 10.0, i / 200.0));
    return out;
}
/// The number that is farthest from the budget.
double farthest(const std::vector<double>& used) {
    return *std::ranges::max_element(used, {}, [](double x) { return std::abs(x - budget_m); });
}
report::Panel requirement_panel(const char* title, const char* unit) {
    report::Panel p{title, "outage, min", unit};
    p.time_axis = false;
    p.log_y = true;
    p.height = 260;
    return p;
}
constexpr std::array tabled_outages{10.0, 30.0, 60.0, 100.0, 300.0, 600.0, 1800.0, 3600.0};

PaperResult figure_1_4_1(const PaperWork&) {
    const Pendulum p;
    PaperResult out;
    std::vector<double> minutes, accel, bare, used;
    const auto printed = [&](double t) { return budget_m / p.from_accelerometer(1.0, t); };
    const double half = std::numbers::pi / p.frequency();
    for (const double t : outages_of_the_figures()) {
        const double needed = requirement(p, budget_m, t).accel;
        minutes.push_back(t / 60.0);
        accel.push_back(needed / units::ug);
        bare.push_back(printed(t) / units::ug);
        double largest = p.from_accelerometer(needed, std::min(t, half));
        for (int k = 1; k <= 50; ++k) largest = std::max(largest, p.from_accelerometer(needed, t * k / 50.0));
        used.push_back(largest);
    }
    // within half a period the end of the outage is the worst case; beyond, the half period
    const double hour = requirement(p, budget_m, 3600.0).accel;
    const double at_half = p.from_accelerometer(hour, half);
    out.numbers = {{"largest", at_half / hour * p.frequency() * p.frequency()},
                   {"accelerometer", farthest(used)},
                   {"monotone", printed(3600.0) / hour}};
    report::ResultTable table{
        "5 m over an outage",
        {{"outage_s", "outage", "s", "g"}, {"accel_ug", "accelerometer", "ug"}, {"accel_bare_ug", "(1.4.5) as printed", "ug"}}};
    for (const double t : tabled_outages)
        table.rows.push_back({t, requirement(p, budget_m, t).accel / units::ug, printed(t) / units::ug});
    out.tables.push_back(std::move(table));
    report::Panel panel = requirement_panel("figure 1.4.1: accelerometer for 5 m", "ug");
    panel.series = {paper_curve("outages up to this", minutes, accel),
                    paper_curve("(1.4.5) as printed", minutes, bare, report::Ink::Vermillion, report::Mark::Dashed)};
    out.panels = {std::move(panel)};
    return out;
}

PaperResult figure_1_4_2(const PaperWork&) {
    const Pendulum p;
    PaperResult out;
    std::vector<double> minutes, drift, used;
    for (const double t : outages_of_the_figures()) {
        const double needed = requirement(p, budget_m, t).gyro;
        minutes.push_back(t / 60.0);
        drift.push_back(needed / units::deg_per_hour);
        used.push_back(p.from_gyro(needed, t));
    }
    out.numbers = {{"gyro", farthest(used)}};
    report::ResultTable table{"5 m over an outage", {{"outage_s", "outage", "s", "g"}, {"gyro_deg_h", "gyro", "deg/h"}}};
    for (const double t : tabled_outages) table.rows.push_back({t, requirement(p, budget_m, t).gyro / units::deg_per_hour});
    out.tables.push_back(std::move(table));
    report::Panel panel = requirement_panel("figure 1.4.2: gyro for 5 m", "deg/h");
    panel.series = {paper_curve("drift", minutes, drift)};
    out.panels = {std::move(panel)};
    return out;
}

}  // namespace

std::vector<PaperItem> paper_a_errors() {
    return {{"A", "figure-1.4.1", "requirement curve: the accelerometer for 5 m", 0, 0.1, figure_1_4_1},
            {"A", "figure-1.4.2", "requirement curve: the gyro for 5 m", 0, 0.1, figure_1_4_2},
            {"A", "figure-4.1.1", "a tilt of 1e-3 rad at rest", 0, 0.1, figure_411},
            {"A", "figure-4.1.2", "a gyro drift of 0.01 deg/h at rest", 0, 0.1, figure_412},
            {"A", "figure-4.1.3", "a velocity error of 1 m/s at rest", 0, 0.1, figure_413},
            {"A", "figure-4.1.4", "tilt, gyro, accelerometer: each one's part and their sum", 0, 0.1, figure_414}};
}

}  // namespace schuler::study
