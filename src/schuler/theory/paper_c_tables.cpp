#include "schuler/theory/paper_c_tables.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

namespace schuler::theory {
namespace {

enum class Kind { Value, Amplitude, Phase };
enum class Unit { Si, Degrees, Metres };  ///< of angles; metres along the equator are printed without sign

struct Cell {
    int vehicle, set;
    Kind kind;
    EquatorError error;
    Unit unit;
    const char* printed;
    const char* remark = "";
};

constexpr const char* signed_amplitude = "printed with a signed amplitude: the same oscillation";
constexpr auto V = Kind::Value, A = Kind::Amplitude, P = Kind::Phase;
constexpr auto Si = Unit::Si, Deg = Unit::Degrees, Met = Unit::Metres;

const std::vector<Cell>& cells() {
    static const std::vector<Cell> all{
        // Table 2: the fighter.
        // clang-format off
        {0, 1, V, vh, Si, "0.45"}, {0, 1, A, vh, Si, "1.17e-5"}, {0, 1, P, vh, Si, "0"},
        {0, 1, V, ve, Si, "-0.03"}, {0, 1, A, ve, Si, "1.3e-4"}, {0, 1, P, ve, Si, "pi/2"},
        {0, 1, V, height, Si, "258"}, {0, 1, A, height, Si, "-9.4e-3"}, {0, 1, P, height, Si, "pi/2"},
        {0, 1, V, lon, Si, "-5e-6"}, {0, 1, V, lon, Deg, "-2.98e-4"}, {0, 1, V, lon, Met, "33"},
        {0, 1, A, lon, Si, "1.64e-8"}, {0, 1, A, lon, Deg, "9.42e-7"}, {0, 1, A, lon, Met, "0.11"}, {0, 1, P, lon, Si, "0"},
        {0, 2, V, vn, Si, "1.2e-3"}, {0, 2, A, vn, Si, "-1.2e-3"}, {0, 2, P, vn, Si, "0"},
        {0, 2, V, lat, Si, "-4.11e-8"}, {0, 2, V, lat, Deg, "-2.36e-6"}, {0, 2, V, lat, Met, "0.26"},
        {0, 2, A, lat, Si, "1.57e-7"}, {0, 2, A, lat, Deg, "9e-6"}, {0, 2, A, lat, Met, "1"}, {0, 2, P, lat, Si, "pi/2"},
        {0, 3, V, vh, Si, "-0.03"}, {0, 3, A, vh, Si, "1.11e-4"}, {0, 3, P, vh, Si, "pi/2"},
        {0, 3, V, ve, Si, "3.3e-3"}, {0, 3, A, ve, Si, "-1.2e-3"}, {0, 3, P, ve, Si, "0"},
        {0, 3, V, height, Si, "-16"}, {0, 3, A, height, Si, "0.09"}, {0, 3, P, height, Si, "0"},
        {0, 3, V, lon, Si, "2.91e-7"}, {0, 3, V, lon, Deg, "1.67e-5"}, {0, 3, V, lon, Met, "1.87", "the last digit"},
        {0, 3, A, lon, Si, "1.57e-7", "its degrees and metres are right"}, {0, 3, A, lon, Deg, "8.92e-6"},
        {0, 3, A, lon, Met, "0.99"}, {0, 3, P, lon, Si, "pi/2"},
        // clang-format on
        // Table 3: the ship.
        // clang-format off
        {1, 1, V, vh, Si, "0.47"}, {1, 1, A, vh, Si, "3.93e-6"}, {1, 1, P, vh, Si, "0"},
        {1, 1, V, ve, Si, "-0.03"}, {1, 1, A, ve, Si, "9.79e-5"}, {1, 1, P, ve, Si, "pi/2"},
        {1, 1, V, height, Si, "270"}, {1, 1, A, height, Si, "-3e-3"}, {1, 1, P, height, Si, "pi/2"},
        {1, 1, V, lon, Si, "-2.42e-6"}, {1, 1, V, lon, Deg, "-1.39e-6", "the power of ten, and the last digit"},
        {1, 1, V, lon, Met, "15"},
        {1, 1, A, lon, Si, "1.24e-8"}, {1, 1, A, lon, Deg, "7.08e-7"}, {1, 1, A, lon, Met, "0.08"}, {1, 1, P, lon, Si, "0"},
        {1, 2, V, vn, Si, "1.2e-3"}, {1, 2, A, vn, Si, "-1.2e-3"}, {1, 2, P, vn, Si, "0"},
        {1, 2, V, lat, Si, "-3.95e-8"}, {1, 2, V, lat, Deg, "-2.26e-6"}, {1, 2, V, lat, Met, "0.25"},
        {1, 2, A, lat, Si, "1.57e-7"}, {1, 2, A, lat, Deg, "9e-6"}, {1, 2, A, lat, Met, "1"}, {1, 2, P, lat, Si, "pi/2"},
        {1, 3, V, vh, Si, "-1.3e-3", "the power of ten"}, {1, 3, A, vh, Si, "4.98e-5"}, {1, 3, P, vh, Si, "pi/2"},
        {1, 3, V, ve, Si, "2e-3"}, {1, 3, A, ve, Si, "-1.2e-3"}, {1, 3, P, ve, Si, "0"},
        {1, 3, V, height, Si, "-7.72"}, {1, 3, A, height, Si, "0.04"}, {1, 3, P, height, Si, "0"},
        {1, 3, V, lon, Si, "3.04e-8"}, {1, 3, V, lon, Deg, "1.74e-6"}, {1, 3, V, lon, Met, "0.19"},
        {1, 3, A, lon, Si, "1.57e-7"}, {1, 3, A, lon, Deg, "8.98e-6"}, {1, 3, A, lon, Met, "1"}, {1, 3, P, lon, Si, "pi/2"},
        // clang-format on
    };
    return all;
}

constexpr const char* error_names[6] = {"dvN", "dvH", "dvE", "dH", "dphi", "dlambda"};
bool is_angle(EquatorError e) { return e == lat || e == lon; }

std::string unit_of(const Cell& c) {
    if (c.kind == P) return "rad";
    if (!is_angle(c.error)) return c.error == height ? "m" : "m/s";
    return c.unit == Si ? "rad" : c.unit == Deg ? "deg" : "m";
}

std::string quantity_of(const Cell& c) {
    const std::string name = error_names[c.error];
    return c.kind == V   ? fmt::format("{}({:.0f} s)", name, paper_time)
           : c.kind == A ? "amplitude of " + name
                         : "phase of " + name;
}

double printed_phase(const char* text) { return std::string_view(text) == "0" ? 0.0 : 0.5 * std::numbers::pi; }

bool within_digits(const std::string& printed, double right) {
    const PrintedNumber n = printed_number(printed);
    return std::abs(n.value - right) <= n.half_unit * (1.0 + 1e-9);
}

/// The amplitude printed for the same oscillation as a phase.
const Cell& amplitude_of(const Cell& phase) {
    for (const Cell& c : cells())
        if (c.kind == A && c.vehicle == phase.vehicle && c.set == phase.set && c.error == phase.error && c.unit == Si) return c;
    throw computation_error("a phase without its amplitude");
}

PaperEntry entry_of(const Cell& c, const PaperVehicle& vehicle) {
    const EquatorFlight flight(vehicle.speed, vehicle.height);
    const Vector6 initial = paper_initial_errors(c.set);
    PaperEntry e{vehicle.name, c.set, quantity_of(c), unit_of(c), c.printed, 0.0, false, c.remark};
    if (c.kind == P) {
        const bool negative = printed_number(amplitude_of(c).printed).value < 0.0;
        e.right = flight.oscillation(initial).phase(c.error);
        const double meant = printed_phase(c.printed) + (negative ? std::numbers::pi : 0.0);
        e.agrees = std::abs(std::remainder(meant - e.right, 2.0 * std::numbers::pi)) < 1e-6;
        if (negative) e.remark = signed_amplitude;
        return e;
    }
    e.right = c.kind == V ? (flight.transition(paper_time) * initial)(c.error) : flight.oscillation(initial).amplitude(c.error);
    if (is_angle(c.error) && c.unit == Deg) e.right /= units::deg;
    if (is_angle(c.error) && c.unit == Met) e.right *= flight.constants().R;
    const bool by_size = c.kind == A || (is_angle(c.error) && c.unit == Met);
    const PrintedNumber n = printed_number(c.printed);
    e.agrees = by_size ? std::abs(std::abs(n.value) - std::abs(e.right)) <= n.half_unit * (1.0 + 1e-9)
                       : within_digits(c.printed, e.right);
    if (c.kind == A && n.value < 0.0) e.remark = signed_amplitude;
    return e;
}

void add_roots(std::vector<PaperEntry>& out, const PaperVehicle& vehicle, const char* const (&printed)[7]) {
    const EquatorConstants c = EquatorFlight(vehicle.speed, vehicle.height).constants();
    const double period = 2.0 * std::numbers::pi / c.omega, period_mu = 2.0 * std::numbers::pi / c.mu;
    const double right[7] = {c.beta3, c.omega, c.mu, period, period / 60.0, period_mu, period_mu / 60.0};
    const char* const names[7] = {"beta_3", "omega", "mu", "period of omega", "period of omega", "period of mu", "period of mu"};
    const char* const unit[7] = {"1/s", "rad/s", "rad/s", "s", "min", "s", "min"};
    for (std::size_t i = 0; i < 7; ++i)
        out.push_back({vehicle.name, 0, names[i], unit[i], printed[i], right[i], within_digits(printed[i], right[i]), ""});
}

}  // namespace

PrintedNumber printed_number(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0') throw input_error(fmt::format("\"{}\" is not a number", text));
    const std::size_t exponent = std::min(text.find('e'), text.size()), point = text.find('.');
    const int decimals = point == std::string::npos ? 0 : static_cast<int>(exponent - point - 1);
    const int power = exponent < text.size() ? std::atoi(text.c_str() + exponent + 1) : 0;
    return {value, 0.5 * std::pow(10.0, power - decimals)};
}

std::vector<PaperVehicle> paper_vehicles() { return {{"fighter", 600.0, 10000.0}, {"ship", 10.0, 0.0}}; }

Vector6 paper_initial_errors(int set) {
    Vector6 x = Vector6::Zero();
    if (set == 1) x(height) = 1.0;
    if (set == 2) x(lat) = 1.57e-7;
    if (set == 3) x(lon) = 1.57e-7;
    return x;
}

std::vector<PaperEntry> paper_tables() {
    const std::vector<PaperVehicle> vehicles = paper_vehicles();
    std::vector<PaperEntry> out;
    const double angle = 1.57e-7 / units::deg;
    out.push_back({"", 0, "initial dphi, dlambda", "deg", "8.97e-6", angle, within_digits("8.97e-6", angle),
                   "8.97e-6 deg is 1 m, 1.57e-7 rad is 1.003 m: the tables use the latter"});
    for (const auto& [printed, h] : {std::pair{"7440", 0.0}, std::pair{"7370", 1e5}, std::pair{"6820", 1e6}}) {
        const double limit = speed_limits(h).east;
        const bool cut = std::floor(limit / 10.0) * 10.0 == printed_number(printed).value;
        out.push_back({"", 0, fmt::format("limiting speed at {:.0f} km", h / 1000.0), "m/s", printed, limit, cut,
                       fmt::format("cut to tens; holds eastward, westward it is {:.2f}", speed_limits(h).west)});
    }
    constexpr const char* fighter[7] = {"0.0017323", "0.0012354", "0.0012413", "5086", "84.8", "5062", "84.6"};
    constexpr const char* ship[7] = {"0.0017471", "0.0012383", "0.0012412", "5074", "84.6", "5062", "84.4"};
    add_roots(out, vehicles[0], fighter);
    add_roots(out, vehicles[1], ship);
    for (const Cell& c : cells()) out.push_back(entry_of(c, vehicles[static_cast<std::size_t>(c.vehicle)]));
    return out;
}

}  // namespace schuler::theory
