#include "schuler/settings/config/anomaly_options.h"

#include "schuler/earth/enu.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"

#include <algorithm>
#include <cmath>

namespace schuler::settings {
namespace {

using gravimetry::DisturbanceAxes;
using gravimetry::DisturbanceKind;
using sim::AnomalyPart;

constexpr std::pair<const char*, AnomalyPart::Kind> kinds[] = {{"constant", AnomalyPart::Kind::Constant},
                                                               {"step", AnomalyPart::Kind::Step},
                                                               {"ramp", AnomalyPart::Kind::Ramp},
                                                               {"harmonic", AnomalyPart::Kind::Harmonic},
                                                               {"gauss_markov_1", AnomalyPart::Kind::GaussMarkov1},
                                                               {"gauss_markov_2", AnomalyPart::Kind::GaussMarkov2}};

constexpr const char* anomaly_form =
    "an [[anomaly]] has kind (constant, step, ramp, harmonic, gauss_markov_1 or gauss_markov_2), size_mgal = [east, north, up], "
    "start_m and length_m along the track or start_s and length_s";

AnomalyPart::Kind kind_from(const Value& v) {
    if (v.text() != nullptr)
        for (const auto& [name, kind] : kinds)
            if (*v.text() == name) return kind;
    throw input_error(fmt::format("kind = {} is not a kind of anomaly", to_toml(v)), {}, anomaly_form);
}

Eigen::Vector3d size_from(const Value& v) {
    Eigen::Vector3d enu;
    const bool list = v.list() != nullptr && v.list()->size() == 3;
    for (std::size_t i = 0; i < 3; ++i) {
        const Value* x = list ? &(*v.list())[i] : nullptr;
        if (x == nullptr || !x->is_number() || !(std::abs(x->number()) < 1e5))
            throw input_error(fmt::format("size_mgal = {} is not three numbers", to_toml(v)), {}, "write size_mgal = [0, 0, 10]");
        enu(static_cast<int>(i)) = x->number() * units::mgal;
    }
    return enu;
}

AnomalyPart part_from(const ValueTable& table) {
    AnomalyPart part;
    bool kind = false, length = false, by_distance = false;
    for (const auto& [name, v] : table) {
        if (name == "kind") {
            part.kind = kind_from(v);
            kind = true;
        } else if (name == "size_mgal") {
            part.size_n = earth::ned_from_enu(size_from(v));
        } else if (name == "start_m" || name == "length_m" || name == "start_s" || name == "length_s") {
            const bool is_length = name.starts_with("length");
            if (!v.is_number() || !(std::abs(v.number()) < 1e9) || (is_length && !(v.number() > 0.0)))
                throw input_error(fmt::format("{} = {} is not usable", name, to_toml(v)), {}, anomaly_form);
            (is_length ? part.length : part.start) = v.number();
            (name.ends_with("_s") ? part.by_time : by_distance) = true;
            length = length || is_length;
        } else {
            throw input_error(fmt::format("an anomaly has no \"{}\"", name), {}, anomaly_form);
        }
    }
    const bool extended = part.kind != AnomalyPart::Kind::Constant && part.kind != AnomalyPart::Kind::Step;
    if (!kind) throw input_error("an anomaly lacks its kind", {}, anomaly_form);
    if (extended && !length) throw input_error("an anomaly of this kind needs length_m or length_s", {}, anomaly_form);
    if (part.by_time && by_distance) throw input_error("an anomaly runs either by metres or by seconds", {}, anomaly_form);
    return part;
}

auto gravity(double GravityConfig::*field) {
    return [=](auto& c) -> auto& { return c.gravity.*field; };
}

Option<Config> steps_option() {
    OptionSpec spec = detail::spec("gravity.steps_s", Shape::Numbers,
                                   "seconds after the first fix at which the constant part may have changed, by its prior");
    spec.low = 0.0;
    spec.high = 1e9;
    return {std::move(spec),
            [](Config& c, const Value& v) {
                c.gravity.steps.clear();
                for (const Value& x : *v.list()) c.gravity.steps.push_back(x.number());
                std::ranges::sort(c.gravity.steps);
            },
            [](const Config& c) -> std::optional<Value> {
                if (c.gravity.steps.empty()) return std::nullopt;
                ValueList list;
                for (const double t : c.gravity.steps) list.push_back({t});
                return Value{std::move(list)};
            }};
}

}  // namespace

std::vector<AnomalyPart> anomalies_from(const ValueList& tables) {
    std::vector<AnomalyPart> out;
    for (const Value& item : tables) out.push_back(part_from(*item.table()));
    return out;
}

std::optional<Value> value_of(const std::vector<AnomalyPart>& parts) {
    if (parts.empty()) return std::nullopt;
    ValueList list;
    for (const AnomalyPart& p : parts) {
        ValueTable table;
        for (const auto& [name, kind] : kinds)
            if (kind == p.kind) table.emplace_back("kind", Value{std::string(name)});
        const Eigen::Vector3d enu = earth::enu_from_ned(p.size_n);
        table.emplace_back(
            "size_mgal",
            Value{ValueList{{in_unit(enu.x(), units::mgal)}, {in_unit(enu.y(), units::mgal)}, {in_unit(enu.z(), units::mgal)}}});
        if (p.kind != AnomalyPart::Kind::Constant) table.emplace_back(p.by_time ? "start_s" : "start_m", Value{p.start});
        if (p.kind != AnomalyPart::Kind::Constant && p.kind != AnomalyPart::Kind::Step)
            table.emplace_back(p.by_time ? "length_s" : "length_m", Value{p.length});
        list.push_back({std::move(table)});
    }
    return Value{std::move(list)};
}

OptionSpec anomaly_spec(const std::string& help) { return detail::spec("anomaly", Shape::Tables, help); }

void check_gravity(const GravityConfig& gravity) {
    const int degree = gravimetry::DisturbanceModel{.kind = gravity.model}.degree();
    const bool slope = degree < 1 || std::isfinite(gravity.slope), curvature = degree < 2 || std::isfinite(gravity.curvature);
    if (slope && curvature) return;
    throw input_error("the polynomial lacks a prior", {{}, 0, 0, "gravity.model"},
                      fmt::format("give gravity.{}, one sigma at the start", slope ? "curvature_mgal_km2" : "slope_mgal_km"));
}

void add_gravity_options(OptionTable<Config>& table) {
    constexpr double per_km = units::mgal / 1000.0;
    const auto vector = [](Eigen::Vector3d GravityConfig::*field) { return [=](auto& c) -> auto& { return c.gravity.*field; }; };
    table
        .add(choice<Config, DisturbanceKind>("gravity.model",
                                             {{"constant", DisturbanceKind::Constant},
                                              {"gauss_markov_1", DisturbanceKind::FirstOrder},
                                              {"ramp", DisturbanceKind::RampAndFirstOrder},
                                              {"quadratic", DisturbanceKind::QuadraticAndFirstOrder},
                                              {"gauss_markov_2", DisturbanceKind::SecondOrder},
                                              {"gauss_markov_3", DisturbanceKind::ThirdOrder}},
                                             "estimated disturbance: a constant plus a process along the track (ramp, "
                                             "quadratic: a polynomial and a first-order one)",
                                             [](auto& c) -> auto& { return c.gravity.model; }))
        .add(choice<Config, DisturbanceAxes>("gravity.axes",
                                             {{"ned", DisturbanceAxes::LocalLevel}, {"ecef", DisturbanceAxes::EarthFixed}},
                                             "axes of the disturbance model: north, east, down or the paper's Earth-fixed ones",
                                             [](auto& c) -> auto& { return c.gravity.axes; }))
        .add(number<Config>("gravity.length_m", 1.0, 1.0, 1e9, "correlation length of the process along the track",
                            gravity(&GravityConfig::length)))
        .add(number<Config>("gravity.time_s", 1.0, 1.0, 1e9,
                            "correlation time of the process, where it depends on time instead of distance",
                            gravity(&GravityConfig::time)))
        .add(vector3<Config>("gravity.sigma_mgal", units::mgal, 0, 1e5, "one sigma of the process, east, north, up",
                             vector(&GravityConfig::sigma_enu)))
        .add(vector3<Config>("gravity.prior_mgal", units::mgal, 0, 1e5, "one sigma of the constant part, east, north, up",
                             vector(&GravityConfig::prior_enu)))
        .add(number<Config>("gravity.slope_mgal_km", per_km, 0, 1e5, "one sigma of a polynomial's slope at the start",
                            gravity(&GravityConfig::slope)))
        .add(number<Config>("gravity.curvature_mgal_km2", 1e-3 * per_km, 0, 1e5,
                            "one sigma of a polynomial's second derivative at the start", gravity(&GravityConfig::curvature)))
        .add(number<Config>("gravity.gnss_systematic_m", 1.0, 0, 100,
                            "constant error of the fixes, one sigma; default: their slowly varying error",
                            gravity(&GravityConfig::gnss_position)))
        .add(number<Config>("gravity.gnss_systematic_m_s", 1.0, 0, 10, "constant error of the velocities of the fixes, one sigma",
                            gravity(&GravityConfig::gnss_velocity)))
        .add(number<Config>("gravity.lowpass_s", 1.0, 2, 1e5,
                            "length of the low-pass filter of the classical pipeline; default: the resolution of the smoother",
                            gravity(&GravityConfig::lowpass)))
        .add(flag<Config>("gravity.smooth", "fixed-interval smoother after the filter",
                          [](auto& c) -> auto& { return c.gravity.smooth; }))
        .add(steps_option())
        .add(flag<Config>("gravity.height_aid", "uses the barometer or depth gauge too, with a constant error as a state",
                          [](auto& c) -> auto& { return c.gravity.height_aid; }))
        .add({anomaly_spec("semi-real mode: injected into recorded accelerometers as if it were gravity; [[anomaly]] with kind, "
                           "size_mgal, start and length in _m or _s"),
              [](Config& c, const Value& v) { c.gravity.inject = anomalies_from(*v.list()); },
              [](const Config& c) { return value_of(c.gravity.inject); }});
}

}  // namespace schuler::settings
