#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
#include "schuler/study/parts.h"
#include "schuler/study/theory/analyze.h"
#include "schuler/theory/ideal_operation.h"
#include "schuler/theory/paper_c_tables.h"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::study {
namespace {

using namespace theory;

constexpr std::array names{"vn", "vh", "ve", "h", "phi", "lambda"};
constexpr std::array labels{"north velocity, m/s", "up velocity, m/s", "east velocity, m/s",
                            "height, m",           "latitude, rad",    "longitude, rad"};
constexpr int compared_samples = 720;  // number of samples in a comparison
constexpr int shown_samples = 6;       // number of these in tables

report::Json error_object(const Vector6& x) {
    report::Json out;
    for (std::size_t i = 0; i < 6; ++i) out[names[i]] = report::json_number(x(static_cast<Eigen::Index>(i)));
    return out;
}

/// One column per error, after the row label.
report::ResultTable table_of_errors(std::string title, std::string first) {
    report::ResultTable table{std::move(title), {{"", std::move(first)}}};
    for (std::size_t i = 0; i < 6; ++i) table.columns.push_back({names[i], names[i], "", ".6g"});
    return table;
}
void add_errors(report::ResultTable& table, std::string name, const Vector6& x) {
    std::vector<report::Cell>& row = table.rows.emplace_back(std::vector<report::Cell>{std::move(name)});
    row.insert(row.end(), x.begin(), x.end());
}

double period(double frequency) { return 2.0 * std::numbers::pi / frequency; }

std::string verdict(const EquatorFlight& flight, const SpeedLimits& limits) {
    const EquatorConstants& c = flight.constants();
    const std::string north = "north velocity and latitude oscillate without damping (stable)";
    if (flight.within_limits())
        return fmt::format(
            "unstable: {}, but up and east velocity, height and longitude grow as exp(t/{:.1f} s), doubling every {:.1f} s",
            north, 1.0 / c.beta3, std::numbers::ln2 / c.beta3);
    double fastest = 0.0;
    for (const std::complex<double> root : flight.roots()) fastest = std::max(fastest, root.real());
    return fmt::format(
        "beyond the limiting speed {} ({:.2f} m/s): the specific force points down ({:.4g} m/s2 up), and the channel of height "
        "and longitude "
        "no longer has two real and two imaginary roots, so that beta3 and mu do not exist; it is unstable, growing as "
        "exp(t/{:.1f} s); {}",
        flight.speed() > 0.0 ? "east" : "west", flight.speed() > 0.0 ? limits.east : limits.west, c.a_h, 1.0 / fastest, north);
}

std::string limits_table(double height) {
    report::ResultTable table{"limiting speeds",
                              {{"", "height", "km", ".6g"}, {"", "east", "m/s", ".2f"}, {"", "west", "m/s", ".2f"}}};
    std::vector<double> heights{0.0, 1e4, 1e5, 1e6};
    if (std::ranges::find(heights, height) == heights.end()) heights.push_back(height);
    std::ranges::sort(heights);
    for (const double h : heights) {
        const SpeedLimits s = speed_limits(h);
        table.rows.push_back({h / 1000.0, s.east, s.west});
    }
    return report::table_text(table);
}

std::string description(const EquatorFlight& flight, double t, const Matrix6& P, const std::string& judged) {
    const EquatorConstants& c = flight.constants();
    std::string out = fmt::format("along the equator at {:g} m/s east, height {:g} m (paper C's Earth, a sphere)\n",
                                  flight.speed(), flight.height());
    const auto frequency = [&](const char* name, double w, const char* what) {
        out +=
            fmt::format("  {:<6} {:.8g} rad/s, period {:.3f} s = {:.2f} min: {}\n", name, w, period(w), period(w) / 60.0, what);
    };
    frequency("omega", c.omega, "north velocity and latitude");
    if (flight.within_limits()) {
        frequency("mu", c.mu, "up and east velocity, height, longitude");
        out += fmt::format("  beta3  {:.8g} 1/s: the same four grow e-fold in {:.1f} s\n", c.beta3, 1.0 / c.beta3);
    } else {
        for (const std::complex<double> root : flight.roots())
            out += fmt::format("  root   {:.8g} {:+.8g}i 1/s\n", root.real(), root.imag());
    }
    out += "verdict: " + judged + "\n\n" + limits_table(flight.height());
    report::ResultTable transition =
        table_of_errors(fmt::format("transition matrix P({:g} s): row = error then, column = error at the start", t), "error");
    for (Eigen::Index i = 0; i < 6; ++i) add_errors(transition, names[static_cast<std::size_t>(i)], P.row(i).transpose());
    return out + "\n" + report::table_text(transition);
}

std::string error_table(const EquatorRequest& r, const Vector6& at, const Vector6& forced, const EquatorFlight::Oscillation& o) {
    report::ResultTable table{"",
                              {{"", "error"},
                               {"", "start", "", ".6g"},
                               {"", fmt::format("at {:g} s", r.time), "", ".6g"},
                               {"", "amplitude", "", ".6g"},
                               {"", "phase", "rad", ".6g"},
                               {"", r.misalignment.isZero(0.0) ? "" : "by misalignment", "", ".6g"}}};
    for (Eigen::Index i = 0; i < 6; ++i)
        table.rows.push_back({labels[static_cast<std::size_t>(i)], r.errors(i), at(i), o.amplitude(i), o.phase(i), forced(i)});
    return "\n" + report::table_text(table);
}

void add_paper(report::Outcome& out, report::Json& document) {
    report::ResultTable table{
        "what paper C prints and what its corrected equations give (docs/theory.md); * marks where the paper is off",
        {{"", "vehicle"},
         {"vehicle", ""},
         {"set", "set"},
         {"quantity", "quantity"},
         {"unit", "unit"},
         {"printed", "printed"},
         {"right", "right", "", ".8g"},
         {"agrees", ""},
         {"remark", "remark"}}};
    constexpr std::array<const char*, 4> sets{"", "I", "II", "III"};
    for (const PaperEntry& e : paper_tables())
        table.rows.push_back({fmt::format("{} {}", e.agrees ? " " : "*", e.vehicle), e.vehicle,
                              sets[static_cast<std::size_t>(e.set)], e.quantity, e.unit, e.printed, e.right, e.agrees, e.remark});
    out.tables += report::table_text(table);
    document["paper"] = report::table_json(table);
}

/// Panels of one error: three solutions, and their differences.
void add_panels(report::Section& section, const std::vector<Comparison>& rows, const std::vector<Vector6>& analytic,
                std::size_t i) {
    const auto at = static_cast<Eigen::Index>(i);
    std::vector<double> t, nonlinear, linear, closed, missed, integrated;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        t.push_back(rows[k].t);
        nonlinear.push_back(rows[k].nonlinear(at));
        linear.push_back(rows[k].linear(at));
        missed.push_back(std::abs(rows[k].nonlinear(at) - rows[k].linear(at)));
        if (analytic.empty()) continue;
        closed.push_back(analytic[k](at));
        integrated.push_back(std::abs(rows[k].linear(at) - analytic[k](at)));
    }
    report::Panel values{labels[i], "time, s", labels[i]};
    values.series = {{"complete equations", t, nonlinear, report::Ink::Blue},
                     {"linear equations", t, linear, report::Ink::Vermillion, report::Mark::Dashed}};
    report::Panel differences{std::string("differences: ") + labels[i], "time, s", labels[i]};
    differences.series = {{"complete minus linear", t, missed, report::Ink::Blue}};
    differences.log_y = true;
    differences.height = 140;
    if (!analytic.empty()) {
        std::vector<double> few_t, few;
        for (std::size_t k = 0; k < t.size(); k += 12) few_t.push_back(t[k]), few.push_back(closed[k]);
        values.series.push_back({"closed form", few_t, few, report::Ink::Text, report::Mark::Dots});
        differences.series.push_back({"linear minus closed form", t, integrated, report::Ink::Vermillion});
    }
    section.groups.push_back({labels[i], {values, differences}, {}});
}

void add_comparison(const EquatorRequest& r, report::Outcome& out, report::Json& document) {
    if (r.errors.isZero(0.0))
        throw input_error("there is no error to compare", {{}, 0, 0, "compare"}, "give one, for example --dh 1");
    if (!r.misalignment.isZero(0.0))
        throw input_error("compares right inertial attitudes only", {{}, 0, 0, "compare"}, "leave out --misalignment");
    if (std::abs(r.latitude_deg) > 89.0)
        throw input_error("too near a pole for the geographic frame", {{}, 0, 0, "latitude-deg"}, "give up to 89");
    if (!(r.time > 0.0 && r.time <= units::hour * 24.0))
        throw input_error("out of range for a comparison", {{}, 0, 0, "time"}, "give up to 86400 s");
    PaperCEarth earth;
    if (!r.ellipsoid) earth.e2 = 0.0;
    Vector6 start;
    start << r.north_speed, r.up_speed, r.speed, r.height, r.latitude_deg * units::deg, 0.0;
    const std::vector<Comparison> rows = compare_integrations(earth, start, r.errors, r.time, compared_samples);
    std::vector<Vector6> analytic;
    const bool on_equator = r.latitude_deg == 0.0 && r.north_speed == 0.0 && r.up_speed == 0.0;
    if (on_equator) {
        const EquatorFlight flight(r.speed, r.height);
        for (const Comparison& c : rows) analytic.push_back(flight.transition(c.t) * r.errors);
    }
    report::Json list = report::Json::array();
    report::ResultTable table =
        table_of_errors(fmt::format("complete equations (two integrations), linear equations, closed form{}",
                                    !on_equator   ? ": none away from the equator"
                                    : r.ellipsoid ? " (of the sphere)"
                                                  : ""),
                        "time and equations");
    report::ReportInput page{"Errors of a strapdown INS, three ways",
                             fmt::format("{:g} m/s east, {:g} m/s north, latitude {:g} deg, height {:g} m", r.speed,
                                         r.north_speed, r.latitude_deg, r.height)};
    page.version = r.version;
    report::Section section{"Error growth",
                            "The complete equations of ideal operation are integrated from a true and a perturbed start; "
                            "their difference beside the linear equations and, on the equator, their closed solution."};
    for (std::size_t k = 0; k < rows.size(); k += compared_samples / shown_samples) {
        report::Json row{{"t_s", rows[k].t},
                         {"nonlinear", error_object(rows[k].nonlinear)},
                         {"linear", error_object(rows[k].linear)},
                         {"analytic", nullptr}};
        const std::string at = fmt::format("{:g} s: ", rows[k].t);
        add_errors(table, at + "complete", rows[k].nonlinear);
        add_errors(table, at + "linear", rows[k].linear);
        if (on_equator) {
            row["analytic"] = error_object(analytic[k]);
            add_errors(table, at + "closed form", analytic[k]);
        }
        list.push_back(row);
    }
    for (std::size_t i = 0; i < 6; ++i) add_panels(section, rows, analytic, i);
    page.sections.push_back(section);
    out.tables += "\n" + report::table_text(table);
    document["compare"] = list;
    write_report(out, r.output.empty() ? std::filesystem::path("out/equator") : r.output, page);
}

report::Outcome equator(const EquatorRequest& r) {
    check_finite({{"dvn", r.errors(vn)},
                  {"dvh", r.errors(vh)},
                  {"dve", r.errors(ve)},
                  {"dh", r.errors(height)},
                  {"dphi", r.errors(lat)},
                  {"dlambda", r.errors(lon)},
                  {"misalignment", r.misalignment.sum()},
                  {"latitude-deg", r.latitude_deg},
                  {"vn", r.north_speed},
                  {"vh", r.up_speed}});
    const EquatorFlight flight(r.speed, r.height);
    const SpeedLimits limits = speed_limits(r.height);
    if (!(r.time >= 0.0) || !std::isfinite(r.time))
        throw input_error("is not a time from the start on", {{}, 0, 0, "time"}, "give seconds, not negative");
    if (!r.compare && (r.latitude_deg != 0.0 || r.north_speed != 0.0 || r.up_speed != 0.0 || r.ellipsoid))
        throw input_error("another flight than along the equator of a sphere has no closed form",
                          {{}, 0, 0, "latitude-deg, --vn, --vh, --ellipsoid"}, "add --compare");
    const Matrix6 P = flight.transition(r.time);
    Vector6 forced = Vector6::Zero();
    if (!r.misalignment.isZero(0.0) && P.allFinite())
        forced = forced_by_misalignment(flight, misalignment_matrix(r.misalignment), 0.0, r.time);
    const Vector6 at = P * r.errors + forced;
    if (!P.allFinite() || !at.allFinite())
        throw input_error("the errors exceed the range of numbers", {{}, 0, 0, "time"}, "give a shorter time");
    const EquatorFlight::Oscillation o = flight.oscillation(r.errors);
    const std::string judged = verdict(flight, limits);
    const EquatorConstants& c = flight.constants();

    report::Json roots = report::Json::array();
    for (const std::complex<double> root : flight.roots()) roots.push_back({root.real(), root.imag()});
    report::Json transition = report::Json::array();
    for (int i = 0; i < 6; ++i) {
        report::Json row = report::Json::array();
        for (int j = 0; j < 6; ++j) row.push_back(P(i, j));
        transition.push_back(row);
    }
    const Vector6 constants = flight.integration_constants(r.errors);
    report::Json C = report::Json::array();
    for (const double x : constants) C.push_back(report::json_number(x));
    // clang-format off
    report::Json document{
        {"roots", {{"beta3", report::json_number(c.beta3)}, {"omega", c.omega}, {"mu", report::json_number(c.mu)}}},
        {"all_roots", roots},
        {"periods_s", {{"omega", period(c.omega)}, {"mu", report::json_number(period(c.mu))}}},
        {"speed_limit_m_s", {{"east", limits.east}, {"west", limits.west}}},
        {"transition", transition},
        {"error", error_object(at)},
        {"forced", error_object(forced)},
        {"amplitude", error_object(o.amplitude)},
        {"phase", error_object(o.phase)},
        {"constants", C},
        {"stable", std::ranges::none_of(flight.roots(), [](const std::complex<double>& root) { return root.real() > 0.0; })},
        {"verdict", judged}};
    // clang-format on
    report::Outcome out;
    if (r.height < 0.0) out.warnings.push_back("the height is below the paper's sea level: its gravity is continued downwards");
    if (!r.paper) out.tables = description(flight, r.time, P, judged);
    if (!r.paper && !(r.errors.isZero(0.0) && r.misalignment.isZero(0.0))) out.tables += error_table(r, at, forced, o);
    if (r.paper) add_paper(out, document);
    if (r.compare) add_comparison(r, out, document);
    out.json = report::text_of(document);
    return out;
}

}  // namespace

report::Outcome analyze_equator(const EquatorRequest& request) {
    return with_option_names([&] { return equator(request); });
}

}  // namespace schuler::study
