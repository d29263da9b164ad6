// Paper C: closed solution of the errors along the equator.
#include "schuler/core/units.h"
#include "schuler/study/papers/item.h"
#include "schuler/study/papers/printed.h"
#include "schuler/theory/equator.h"
#include "schuler/theory/paper_c_tables.h"

#include <fmt/format.h>
#include <unsupported/Eigen/MatrixFunctions>

#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

namespace schuler::study {
namespace {

using namespace theory;
constexpr std::array<const char*, 4> sets{"", "I", "II", "III"};
constexpr std::array<const char*, 6> error_names{"dv N, m/s", "dv H, m/s", "dv E, m/s", "dH, m", "dphi, rad", "dlambda, rad"};

/// In the paper's convention: amplitudes with the printed sign, phases accordingly, metres of longitude without sign.
double as_printed(const PaperEntry& e, const std::string& printed_amplitude) {
    const bool negative = printed_amplitude.starts_with("-");
    if (e.quantity.starts_with("amplitude")) return negative ? -e.right : e.right;
    if (e.quantity.starts_with("phase"))
        return negative ? std::remainder(e.right - std::numbers::pi, 2.0 * std::numbers::pi) : e.right;
    const bool metres_of_angle = e.unit == "m" && !e.quantity.starts_with("dH");
    return metres_of_angle ? std::abs(e.right) : e.right;
}

PaperResult table_of(const char* vehicle) {
    PaperResult out;
    const std::vector<PaperEntry> entries = paper_tables();
    for (const PaperEntry& e : entries) {
        if (e.vehicle != vehicle || e.set == 0) continue;
        std::string amplitude = e.printed;
        if (e.quantity.starts_with("phase"))
            for (const PaperEntry& a : entries)
                if (a.vehicle == e.vehicle && a.set == e.set && a.quantity == "amplitude" + e.quantity.substr(5) &&
                    a.unit != "deg" && !(a.unit == "m" && a.quantity != "amplitude of dH"))
                    amplitude = a.printed;
        out.numbers.emplace_back(fmt::format("{} {} {}", sets[static_cast<std::size_t>(e.set)], e.quantity, e.unit),
                                 as_printed(e, amplitude));
    }
    const bool ship = std::string_view(vehicle) == "ship";
    const PaperVehicle v = paper_vehicles()[ship ? 1 : 0];
    const EquatorFlight flight(v.speed, v.height);
    for (int set = 1; set <= 3; ++set) {
        for (const Eigen::Index i : {Eigen::Index{vh}, Eigen::Index{height}, Eigen::Index{vn}, Eigen::Index{lat}}) {
            if ((set == 2) != (i == vn || i == lat)) continue;
            std::vector<double> t, x;
            for (double s = 0.0; s <= paper_time; s += 10.0) {
                t.push_back(s);
                x.push_back((flight.transition(s) * paper_initial_errors(set))(i));
            }
            const char* name = error_names[static_cast<std::size_t>(i)];
            report::Panel panel{fmt::format("{}, set {}: {}", vehicle, sets[static_cast<std::size_t>(set)], name), "time, s",
                                name};
            panel.series.push_back(paper_curve(name, t, x));
            out.panels.push_back(std::move(panel));
        }
    }
    return out;
}
PaperResult table_2(const PaperWork&) { return table_of("fighter"); }
PaperResult table_3(const PaperWork&) { return table_of("ship"); }

/// Initial errors of one metre of arc at the height of the fighter.
PaperResult table_1(const PaperWork&) {
    PaperResult out;
    const double arc = 1.0 / EquatorFlight(paper_vehicles()[0].speed, paper_vehicles()[0].height).constants().R;
    for (const auto& [set, angle, error] : {std::tuple{2, "dphi", lat}, std::tuple{3, "dlambda", lon}}) {
        const auto key = [&, name = angle](const char* unit) {
            return fmt::format("{} {} {}", sets[static_cast<std::size_t>(set)], name, unit);
        };
        out.numbers.emplace_back(key("rad"), arc);
        out.numbers.emplace_back(key("deg"), arc / units::deg);
        out.numbers.emplace_back(key("m"), paper_initial_errors(set)(error) / arc);
    }
    out.numbers.emplace_back("I dH m", paper_initial_errors(1)(height));
    out.notes =
        "The degrees are those of the metre, 8.969e-6; those of the printed 1.57e-7 rad are 9.00e-6, which table 2 has.\n";
    return out;
}

PaperResult section_5(const PaperWork&) {
    PaperResult out;
    for (const PaperEntry& e : paper_tables())
        if (e.set == 0 && !e.vehicle.empty())
            out.numbers.emplace_back(fmt::format("{} {} {}", e.vehicle, e.quantity, e.unit), e.right);
    return out;
}

PaperResult limits(const PaperWork&) {
    PaperResult out;
    std::vector<double> h, east, west;
    for (const double km : {0.0, 100.0, 1000.0})
        out.numbers.emplace_back(fmt::format("limit {:.0f}", km), 10.0 * std::floor(0.1 * speed_limits(1000.0 * km).east));
    for (double km = 0.0; km <= 1000.0; km += 20.0) {
        h.push_back(km);
        east.push_back(speed_limits(1000.0 * km).east);
        west.push_back(speed_limits(1000.0 * km).west);
    }
    report::Panel panel{"limiting speed", "height, km", "speed, m/s"};
    panel.time_axis = false;
    panel.series = {paper_curve("eastward", h, east),
                    paper_curve("westward (the paper has one limit)", h, west, report::Ink::Vermillion, report::Mark::Dashed)};
    out.panels.push_back(std::move(panel));
    return out;
}

/// (22) literally: in row 2 the factor of the trigonometric terms is missing.
Matrix6 printed_transition(const EquatorFlight& flight, double t) {
    Matrix6 P = flight.transition(t);
    const EquatorConstants& c = flight.constants();
    const double r1 = c.rho1.real(), r2 = c.rho2.real(), b = c.beta3, mu = c.mu;
    const double a33 = (r1 - c.a24) / (2.0 * c.w_n), a35 = (r2 - c.a24) / (2.0 * c.w_n);
    const double a63 = -b * (c.k + a33) / c.a_h, nu = -mu * (c.k + a35) / c.a_h;
    const double D1 = a33 - a35, D2 = nu * b - mu * a63, cs = std::cos(mu * t), sn = std::sin(mu * t);
    P(vh, vh) += 0.5 * mu * a63 * cs / D2;
    P(vh, ve) -= 0.5 * mu * sn / D1;
    P(vh, height) += 0.5 * mu * a33 * sn / D1;
    P(vh, lon) -= 0.5 * b * mu * cs / D2;
    return P;
}

/// exp(A t) with velocities in units of sqrt(g R), heights of R. In m/s and rad the elements of A differ by a factor of 10^7,
/// and the exponential's fourteen squarings lose four digits.
Matrix6 exponential(const EquatorFlight& flight, double t) {
    const double R = flight.constants().R, speed = std::sqrt(flight.constants().g * R);
    Vector6 unit;
    unit << speed, speed, speed, R, 1.0, 1.0;
    const Matrix6 scaled = unit.cwiseInverse().asDiagonal() * flight.dynamics() * unit.asDiagonal() * t;
    return unit.asDiagonal() * Matrix6(scaled.exp()) * unit.cwiseInverse().asDiagonal();
}

PaperResult transition(const PaperWork&) {
    const PaperVehicle v = paper_vehicles()[0];
    const EquatorFlight flight(v.speed, v.height);
    Vector6 x0;
    x0 << 0.01, 0.01, 0.01, 1.0, 1.57e-7, 1.57e-7;
    std::vector<double> t, dvh;
    double others = 0.0, corrected = 0.0;
    for (double s = 0.0; s <= 7200.0; s += 20.0) {
        const Matrix6 right = flight.transition(s);
        const Matrix6 whole = exponential(flight, s);
        const Vector6 difference = printed_transition(flight, s) * x0 - whole * x0;
        t.push_back(s);
        dvh.push_back((printed_transition(flight, s) * x0 - right * x0)(vh));
        const Vector6 size = (whole * x0).cwiseAbs().cwiseMax(1e-9);
        for (Eigen::Index i = 0; i < 6; ++i)
            if (i != vh) others = std::max(others, std::abs(difference(i)) / std::max(size(i), 1.0));
        corrected =
            std::max(corrected, whole.cwiseEqual(0.0).select(right, (right - whole).cwiseQuotient(whole)).cwiseAbs().maxCoeff());
    }
    PaperResult out;
    double largest = 0.0;
    for (const double d : dvh) largest = std::max(largest, std::abs(d));
    // clang-format off
    out.numbers = {{"dvH", largest}, {"others", others}, {"corrected", corrected},
                   {"P(0)", (printed_transition(flight, 0.0) - Matrix6::Identity()).cwiseAbs().maxCoeff()}};
    // clang-format on
    report::Panel panel{"(22) as printed less the right solution", "time, s", "dv H, m/s"};
    panel.series.push_back(paper_curve("fighter, start (24)", t, dvh));
    out.panels.push_back(std::move(panel));
    out.notes = "The paper found 5e-4 m/s in dv_H and blamed the integration: it is the trace of its own misprint.\n";
    return out;
}

}  // namespace

std::vector<PaperItem> paper_c_items() {
    return {{"C", "limits", "limiting speeds", 0, 0.1, limits},
            {"C", "section-5", "roots and periods of both vehicles", 0, 0.1, section_5},
            {"C", "table-1", "initial errors", 0, 0.1, table_1},
            {"C", "table-2", "errors of the fighter after an hour", 0, 0.1, table_2},
            {"C", "table-3", "errors of the ship after an hour", 0, 0.1, table_3},
            {"C", "transition", "the transition matrix (22) as printed and corrected", 0, 0.2, transition}};
}

}  // namespace schuler::study
