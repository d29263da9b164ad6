#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
#include "schuler/study/parts.h"
#include "schuler/study/theory/analyze.h"
#include "schuler/theory/modes.h"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::study {
namespace {

using namespace theory;

/// Display of errors: keys of JSON, headings and units of tables.
struct Shown {
    const char *key, *heading, *unit_name;
    LevelError index;
    double unit;
};
constexpr std::array<Shown, 9> shown{{{"east_m", "east", "m", d_lon, 1.0},
                                      {"north_m", "north", "m", d_lat, 1.0},
                                      {"up_m", "up", "m", d_h, 1.0},
                                      {"v_east_m_s", "v east", "m/s", d_ve, 1.0},
                                      {"v_north_m_s", "v north", "m/s", d_vn, 1.0},
                                      {"v_up_m_s", "v up", "m/s", d_vu, 1.0},
                                      {"about_east_arcsec", "about east", "arcsec", a_e, units::arcsec},
                                      {"about_north_arcsec", "about north", "arcsec", a_n, units::arcsec},
                                      {"about_up_arcsec", "about up", "arcsec", a_u, units::arcsec}}};
constexpr int samples = 2000;

report::Json object(const Vector9& x) {
    report::Json out;
    for (const Shown& s : shown) out[s.key] = report::json_number(x(s.index) / s.unit);
    return out;
}
/// One column per error, after the row labels.
report::ResultTable table_of_errors_shown(std::string title, std::vector<report::TableColumn> first) {
    report::ResultTable table{std::move(title), std::move(first)};
    for (const Shown& e : shown) table.columns.push_back({e.key, e.heading, e.unit_name, ".5g"});
    return table;
}
void add_errors_shown(report::ResultTable& table, std::vector<report::Cell> first, const Vector9& x) {
    std::vector<report::Cell>& row = table.rows.emplace_back(std::move(first));
    for (const Shown& e : shown) row.emplace_back(x(e.index) / e.unit);
}

std::string duration(double seconds) {
    if (!std::isfinite(seconds)) return "-";
    return std::abs(seconds) < 7200.0 ? fmt::format("{:.2f} min", seconds / 60.0)
                                      : fmt::format("{:.3f} h", seconds / units::hour);
}

double period_of(const Mode& m) {
    return m.root.imag() > 0.0 ? 2.0 * std::numbers::pi / m.root.imag() : std::numeric_limits<double>::quiet_NaN();
}
/// Time in which the mode grows or decays e-fold; none if longer than a month.
double e_fold_of(const Mode& m) {
    return std::abs(m.root.real()) > 4e-7 ? 1.0 / m.root.real() : std::numeric_limits<double>::quiet_NaN();
}

LevelFlight flight_of(const SchulerRequest& r) {
    LevelFlight f;
    f.position = {r.latitude_deg * units::deg, 0.0, r.height};
    f.v_enu = r.v_enu;
    f.vertical = vertical_channel_from_name(r.vertical);
    f.time_constant = r.baro_time;
    return f;
}

Vector9 initial_of(const SchulerRequest& r, const LevelFlight& f) {
    const earth::Radii radii = earth::radii(f.earth.ellipsoid, f.position.lat);
    Vector9 x;
    // clang-format off
    x << r.position.x() / ((radii.prime_vertical + r.height) * std::cos(f.position.lat)),
        r.position.y() / (radii.meridian + r.height), r.position.z(), r.velocity, r.attitude;
    // clang-format on
    return x;
}

std::string roots_text(const std::vector<std::complex<double>>& roots) {
    std::string out;
    for (const std::complex<double> root : roots) {
        if (root.imag() < 0.0) continue;
        const std::string imaginary =
            std::abs(root.imag()) > 1e-4 * std::abs(root) ? fmt::format(" +- {:.5g}i", root.imag()) : "";
        out += fmt::format("{}{:.5g}{}", out.empty() ? "" : ", ", root.real(), imaginary);
    }
    return out;
}

std::string vertical_text(const LevelAnalysis& analysis, double tau) {
    const double growth = analysis.vertical_roots(VerticalChannel::Free).front().real();
    const double c = growth * growth;
    std::string out = "vertical channel\n";
    if (growth > 0.0)
        out += fmt::format("  free: roots {} 1/s: a height error grows e-fold in {}, doubles in {}\n",
                           roots_text(analysis.vertical_roots(VerticalChannel::Free)), duration(1.0 / growth),
                           duration(std::acosh(2.0) / growth));
    out += fmt::format(
        "  barometer loop of second order, {:g} s: roots {} 1/s: damped; an accelerometer error of 1 mg leaves {:.4g} m, 1 m of "
        "the barometer {:.6g} m\n",
        tau, roots_text(analysis.vertical_roots(VerticalChannel::SecondOrder)), units::mg * tau * tau, 1.0 + c * tau * tau);
    out += fmt::format("  barometer loop of third order, {:g} s: roots {} 1/s: damped; an accelerometer error leaves nothing\n",
                       tau, roots_text(analysis.vertical_roots(VerticalChannel::ThirdOrder)));
    return out;
}

report::Json vertical_json(const LevelAnalysis& analysis) {
    report::Json out;
    for (const auto& [name, channel] :
         {std::pair{"free", VerticalChannel::Free}, std::pair{"second", VerticalChannel::SecondOrder},
          std::pair{"third", VerticalChannel::ThirdOrder}}) {
        report::Json roots = report::Json::array();
        for (const std::complex<double> root : analysis.vertical_roots(channel)) roots.push_back({root.real(), root.imag()});
        out[name] = roots;
    }
    return out;
}

/// A case of paper A, section 4.1: its statement, the pendulum and the complete model.
struct Case {
    const char* what;
    const char* paper;
    double pendulum;
    double whole;
};

/// Distance in the complete model: after an hour, or the largest within a Schuler period.
double distance(const LevelFlight& f, const Vector9& x, const ConstantErrors& constant, double t, bool largest) {
    double out = 0.0;
    for (const ErrorsAt& e : LevelAnalysis(f, x, constant).history(t, samples)) {
        const double here = e.errors.head<2>().norm();
        out = largest ? std::max(out, here) : here;
    }
    return out;
}

std::vector<Case> paper_cases(const LevelFlight& f) {
    const Pendulum p;
    const double T = 2.0 * std::numbers::pi / p.frequency(), drift = 0.01 * units::deg_per_hour;
    const auto start = [](LevelError i, double size) {
        Vector9 x = Vector9::Zero();
        x(i) = size;
        return x;
    };
    const auto gyro = [](LevelError axis, double size) {
        ConstantErrors c;
        c.gyro(axis - a_e) = size;
        return c;
    };
    ConstantErrors accelerometer;
    accelerometer.accel.x() = 1e-4 * p.g;
    const Vector9 none = Vector9::Zero();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto largest = [&](const Vector9& x, const ConstantErrors& c) { return distance(f, x, c, T, true); };
    const auto after = [&](const ConstantErrors& c, double t) { return distance(f, none, c, t, false); };
    return {
        {"tilt 1e-3 rad, largest (42.2 min)", "1300 m: a tenth of it", p.from_tilt(1e-3, 0.5 * T), largest(start(a_e, 1e-3), {})},
        {"tilt 1e-4 rad, largest (42.2 min)", "", p.from_tilt(1e-4, 0.5 * T), largest(start(a_e, 1e-4), {})},
        {"azimuth 1e-3 rad, largest in 84.4 min", "", nan, largest(start(a_u, 1e-3), {})},
        {"horizontal gyro 0.01 deg/h, after 1 h", "1300 m, stated for a vertical gyro", p.from_gyro(drift, 3600.0),
         after(gyro(a_n, drift), 3600.0)},
        {"vertical gyro 0.01 deg/h, after 1 h", "1300 m: true of a horizontal one", nan, after(gyro(a_u, drift), 3600.0)},
        {"horizontal gyro 0.961 deg/h, after 10 min", "1600 m, drift not stated", p.from_gyro(96.1 * drift, 600.0),
         after(gyro(a_n, 96.1 * drift), 600.0)},
        {"horizontal gyro 876.6 deg/h, after 1 min", "1500 m, drift not stated", p.from_gyro(87660.0 * drift, 60.0),
         after(gyro(a_n, 87660.0 * drift), 60.0)},
        {"velocity 1 m/s, largest (21.1 min)", "bounded", p.from_velocity(1.0, 0.25 * T), largest(start(d_ve, 1.0), {})},
        {"accelerometer 1e-4 g, largest (42.2 min)", "", p.from_accelerometer(1e-4 * p.g, 0.5 * T),
         largest(none, accelerometer)}};
}

void add_cases(const SchulerRequest& r, report::Outcome& out, report::Json& document) {
    SchulerRequest still = r;
    still.v_enu.setZero();
    still.vertical = "fixed";
    report::ResultTable table{
        fmt::format("paper A, section 4.1, at rest, height held; whole model at latitude {:g} deg", r.latitude_deg),
        {{"case", "case"},
         {"paper", ""},
         {"pendulum_m", "pendulum", "m", ".1f"},
         {"whole_model_m", "whole model", "m", ".1f"},
         {"", "the paper"}}};
    for (const Case& c : paper_cases(flight_of(still))) table.rows.push_back({c.what, c.paper, c.pendulum, c.whole, c.paper});
    out.tables += report::table_text(table);
    document["paper"] = report::table_json(table);
}

void add_report(const SchulerRequest& r, const std::vector<ErrorsAt>& history, report::Outcome& out) {
    report::ReportInput page{
        "Natural error motion of a strapdown INS",
        fmt::format("latitude {:g} deg, height {:g} m, vertical channel {}", r.latitude_deg, r.height, r.vertical)};
    page.version = r.version;
    report::Section section{"Errors", "Frozen dynamics of the stated place and velocity, exact in time."};
    std::vector<double> t;
    for (const ErrorsAt& e : history) t.push_back(e.t);
    constexpr std::array<const char*, 3> groups{"position", "velocity", "attitude"};
    constexpr std::array<const char*, 3> units_shown{"m", "m/s", "arc seconds"};
    constexpr std::array inks{report::Ink::Blue, report::Ink::Vermillion, report::Ink::Green};
    constexpr std::array<const char*, 3> axes{"east", "north", "up"};
    for (std::size_t g = 0; g < 3; ++g) {
        report::Panel panel{groups[g], "time, s", fmt::format("{} error, {}", groups[g], units_shown[g])};
        for (std::size_t i = 0; i < 3; ++i) {
            const Shown& s = shown[3 * g + i];
            std::vector<double> y;
            for (const ErrorsAt& e : history) y.push_back(e.errors(s.index) / s.unit);
            panel.series.push_back({axes[i], t, y, inks[i], i == 1 ? report::Mark::Dashed : report::Mark::Line});
        }
        section.groups.push_back({groups[g], {panel}, {}});
    }
    page.sections.push_back(section);
    write_report(out, r.output, page);
}

std::string modes_text(const ModalAnalysis& m) {
    report::ResultTable table = table_of_errors_shown("modes, and the amplitudes that these errors give them",
                                                      {{"", "mode"}, {"", "period"}, {"", "e-fold"}});
    for (const Mode& mode : m.modes)
        add_errors_shown(table, {mode.name, duration(period_of(mode)), duration(e_fold_of(mode))}, mode.amplitude);
    add_errors_shown(table, {"constant part", {}, {}}, m.offset);
    table.rows.push_back({"growing evenly, an hour", {}, {}, m.drift(d_lon) * units::hour});
    return report::table_text(table);
}

std::string foucault_text(const ModalAnalysis& m) {
    if (!(m.foucault_expected > 1e-9)) return "Foucault: no turn of the plane of the oscillation at the equator\n";
    return fmt::format(
        "Foucault: half the difference of the Schuler frequencies is {:.6g} rad/s (period {}); (u + lambda') sin(lat) = {:.6g} "
        "rad/s (period {})\n",
        m.foucault, duration(2.0 * std::numbers::pi / m.foucault), m.foucault_expected,
        duration(2.0 * std::numbers::pi / m.foucault_expected));
}

// clang-format off
report::Outcome analysis(const SchulerRequest& r) {
    check_finite({{"de", r.position.x()}, {"dn", r.position.y()}, {"dh", r.position.z()}, {"dve", r.velocity.x()},
                  {"dvn", r.velocity.y()}, {"dvh", r.velocity.z()}, {"tilt-east", r.attitude.x()}, {"tilt-north", r.attitude.y()},
                  {"azimuth", r.attitude.z()}, {"gyro-east-deg-h", r.gyro_deg_h.x()}, {"gyro-north-deg-h", r.gyro_deg_h.y()},
                  {"gyro-up-deg-h", r.gyro_deg_h.z()}, {"accel-east-ug", r.accel_ug.x()}, {"accel-north-ug", r.accel_ug.y()},
                  {"accel-up-ug", r.accel_ug.z()}, {"baro", r.baro}});
    // clang-format on
    const LevelFlight flight = flight_of(r);
    const ConstantErrors constant{r.gyro_deg_h * units::deg_per_hour, r.accel_ug * units::ug, r.baro};
    const LevelAnalysis analysis(flight, initial_of(r, flight), constant);
    const ModalAnalysis m = analysis.modes();
    const std::vector<ErrorsAt> history = analysis.history(r.time, samples);
    Vector9 largest = Vector9::Zero();
    double farthest = 0.0;
    for (const ErrorsAt& e : history) {
        largest = largest.cwiseMax(e.errors.cwiseAbs());
        farthest = std::max(farthest, e.errors.head<2>().norm());
    }

    report::Outcome out;
    if (r.v_enu.tail<2>().squaredNorm() > 0.0)
        out.warnings.push_back("north or up velocity changes the place with time; the dynamics are those of the start");
    if (!r.paper) {
        out.tables = fmt::format("latitude {:g} deg, height {:g} m, velocity east {:g}, north {:g}, up {:g} m/s; height {}\n",
                                 r.latitude_deg, r.height, r.v_enu.x(), r.v_enu.y(), r.v_enu.z(),
                                 r.vertical == "fixed"  ? "held"
                                 : r.vertical == "free" ? "free"
                                                        : "by a barometer loop of " + r.vertical + " order");
        out.tables += modes_text(m) + foucault_text(m);
        out.tables += vertical_text(analysis, r.baro_time);
        report::ResultTable table = table_of_errors_shown("", {{"", "errors"}});
        add_errors_shown(table, {fmt::format("at {:g} s", r.time)}, history.back().errors);
        add_errors_shown(table, {fmt::format("largest up to {:g} s", r.time)}, largest);
        out.tables += report::table_text(table);
        out.tables += fmt::format("  largest horizontal distance {} m\n", short_number(farthest, 5));
    }
    report::Json modes = report::Json::array();
    for (const Mode& mode : m.modes)
        modes.push_back({{"name", mode.name},
                         {"root", {mode.root.real(), mode.root.imag()}},
                         {"period_s", report::json_number(period_of(mode))},
                         {"e_fold_s", report::json_number(e_fold_of(mode))},
                         {"amplitude", object(mode.amplitude)}});
    report::Json document{{"modes", modes},
                          {"offset", object(m.offset)},
                          {"drift_east_m_s", m.drift(d_lon)},
                          {"foucault", {{"rad_s", report::json_number(m.foucault)}, {"expected_rad_s", m.foucault_expected}}},
                          {"vertical", vertical_json(analysis)},
                          {"error", object(history.back().errors)},
                          {"largest", object(largest)},
                          {"largest_horizontal_m", farthest}};
    if (r.paper) add_cases(r, out, document);
    if (!r.output.empty()) add_report(r, history, out);
    out.json = report::text_of(document);
    return out;
}

}  // namespace

report::Outcome analyze_schuler(const SchulerRequest& request) {
    return with_option_names([&] { return analysis(request); });
}

}  // namespace schuler::study
