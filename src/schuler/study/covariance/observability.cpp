#include "schuler/study/covariance/observability.h"

#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/result_table.h"
#include "schuler/study/covariance/path_observability.h"
#include "schuler/study/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace schuler::study {
namespace {

struct ShownUnit {
    std::string name;
    double size = 1.0;  ///< SI
};
ShownUnit shown_unit(const std::string& si) {
    if (si == "rad") return {"deg", units::deg};
    if (si == "rad/s") return {"deg/h", units::deg / 3600.0};
    if (si == "m/s^2") return {"ug", 1e-6 * units::g0};
    return {si, 1.0};
}

std::string manoeuvre_text(const Observed& o) {
    if (o.left > 0.995) return "none";
    const Manoeuvre m = o.manoeuvre();
    return fmt::format("{} ({:.0f} %)", name_of(m), 100.0 * o.shares[static_cast<std::size_t>(m)]);
}

/// "accel_bias_x 0.71, attitude_east -0.70": up to four parts, the largest first.
std::string combination_text(const PathObservability& p, const Observed& o) {
    constexpr double least = 0.2;
    constexpr std::size_t most = 4;
    std::vector<std::size_t> order(o.weights.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return std::abs(o.weights[i]); });
    std::string out;
    for (const std::size_t i : std::span(order).first(std::min(most, order.size()))) {
        const double w = o.weights[i];
        if (std::abs(w) < least) break;
        out += fmt::format("{}{} {:.2f}", out.empty() ? "" : ", ", p.names[i].name, w);
    }
    return out;
}

report::ResultTable states_table(const PathObservability& p) {
    report::ResultTable table{
        fmt::format("{}: one sigma of each state over {:.0f} s, and what the measurements tell about its initial error", p.name,
                    p.duration_s),
        {{"state", "state"},
         {"unit", "unit"},
         {"start", "at the start", "", ".4g"},
         {"end", "at the end", "", ".4g"},
         {"initial_left_percent", "initial error left, %", "", ".1f"},
         {"manoeuvre", "seen during"},
         {"half_s", "half of it after, s", "", ".0f"}}};
    for (std::size_t i = 0; i < p.states.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        const ShownUnit unit = shown_unit(p.names[i].unit);
        const Observed& o = p.states[i];
        table.rows.push_back({p.names[i].name, unit.name, p.start(at) / unit.size, p.end(at) / unit.size,
                              p.start(at) > 0.0 ? report::Cell(100.0 * o.left) : report::Cell(),
                              p.start(at) > 0.0 ? manoeuvre_text(o) : "no initial error",
                              o.left > 0.995 ? report::Cell() : report::Cell(o.half_s)});
    }
    return table;
}

report::ResultTable combinations_table(const PathObservability& p) {
    report::ResultTable table{"uncorrelated combinations of initial errors, in their sigmas at the start, best observed first",
                              {{"combination", "combination"},
                               {"left_percent", "left, %", "", ".2f"},
                               {"manoeuvre", "seen during"},
                               {"half_s", "half of it after, s", "", ".0f"}}};
    for (const Observed& o : p.combinations)
        table.rows.push_back({combination_text(p, o), 100.0 * o.left, manoeuvre_text(o),
                              o.left > 0.995 ? report::Cell() : report::Cell(o.half_s)});
    return table;
}

report::Json observed_json(const PathObservability& p, const Observed& o) {
    report::Json shares = report::Json::object(), weights = report::Json::object();
    for (std::size_t k = 0; k < manoeuvre_count; ++k)
        shares[std::string(name_of(static_cast<Manoeuvre>(k)))] = report::json_number(o.shares[k]);
    for (std::size_t i = 0; i < o.weights.size(); ++i)
        if (std::abs(o.weights[i]) > 1e-6) weights[p.names[i].name] = report::json_number(o.weights[i]);
    return {{"left", report::json_number(o.left)},
            {"half_s", report::json_number(o.half_s)},
            {"shares", shares},
            {"weights", weights}};
}

/// Options of the motion of gravimetry are not those of a scenario.
void refuse_other_options(const ObservabilityRequest& r) {
    const ObservabilityRequest usual;
    const std::array<std::pair<bool, const char*>, 13> others{{{r.latitude_deg != usual.latitude_deg, "--latitude-deg"},
                                                               {r.longitude_deg != usual.longitude_deg, "--longitude-deg"},
                                                               {r.height != usual.height, "--height"},
                                                               {r.vn != 0.0, "--vn"},
                                                               {r.ve != 0.0, "--ve"},
                                                               {r.vd != 0.0, "--vd"},
                                                               {r.heading_deg != usual.heading_deg, "--heading-deg"},
                                                               {r.turn_deg_s != 0.0, "--turn-deg-s"},
                                                               {r.correlation_time != 0.0, "--correlation-time"},
                                                               {r.polynomial != 0, "--polynomial"},
                                                               {r.tolerance != 0.0, "--tolerance"},
                                                               {r.rhumb || r.frozen, r.rhumb ? "--rhumb" : "--frozen"},
                                                               {r.paper, "--paper"}}};
    for (const auto& [given, option] : others)
        if (given)
            throw input_error("belongs to the steady motion of gravimetry", {.file = {}, .key = option},
                              "leave it out, or leave out the scenario");
}

}  // namespace

report::Outcome analyze_path_observability(const ObservabilityRequest& r) {
    refuse_other_options(r);
    const PathObservability p =
        path_observability(settings::scenario_from(settings::scenario_settings(r.scenario, r.seed)), r.above, r.rate);
    report::Outcome out;
    if (p.refused > 0)
        out.warnings.push_back(fmt::format(
            "{} measurements were refused: the dynamics are too high for {:.4g} Hz; give a higher --rate", p.refused, r.rate));
    if (!p.scheme.empty())
        out.warnings.push_back(
            fmt::format("the analysis is that of the {} scheme, a Kalman filter with the same measurements", p.scheme));
    for (const std::string& key : p.set_aside) out.warnings.push_back(fmt::format("{} has no effect on what is observable", key));
    const report::ResultTable states = states_table(p), combinations = combinations_table(p);
    out.tables = report::table_text(states) + "\n" + report::table_text(combinations);
    report::Json document{{"name", p.name}, {"duration_s", p.duration_s}, {"refused", p.refused}};
    report::Json& list = document["states"] = report::Json::array();
    for (std::size_t i = 0; i < p.states.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        report::Json one = observed_json(p, p.states[i]);
        one.erase("weights");
        one["state"] = p.names[i].name;
        one["unit"] = p.names[i].unit;
        one["start"] = report::json_number(p.start(at));
        one["end"] = report::json_number(p.end(at));
        list.push_back(std::move(one));
    }
    report::Json& combined = document["combinations"] = report::Json::array();
    for (const Observed& o : p.combinations) combined.push_back(observed_json(p, o));
    out.json = report::text_of(document);
    return out;
}

}  // namespace schuler::study
