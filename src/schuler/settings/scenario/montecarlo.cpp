// "montecarlo.*": number of runs, and their variations.
#include "schuler/settings/option_builders.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/scenario/sections.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

namespace schuler::settings {
namespace {

using S = ScenarioConfig;

constexpr std::size_t most_points = 100000;  ///< of a grid: each has separate statistics
constexpr const char* forms =
    "write \"KEY\" = { uniform = [low, high] }, { normal = [mean, sigma] }, { list = [values] }, { sweep = [values] } or "
    "{ sweep = { from = 0, to = 10, steps = 11 } }";

Error bad_parameter(const std::string& key, const std::string& what) {
    return input_error(fmt::format("{}: {}", key, what), {}, forms);
}

/// { from, to, steps }, with log = true in equal ratios.
std::vector<Value> steps_of(const std::string& key, const ValueTable& table) {
    double from = not_given, to = not_given;
    std::int64_t steps = 0;
    bool log = false;
    for (const auto& [name, v] : table) {
        if (name == "from" && v.is_number()) {
            from = v.number();
        } else if (name == "to" && v.is_number()) {
            to = v.number();
        } else if (name == "steps" && v.integer() != nullptr) {
            steps = *v.integer();
        } else if (name == "log" && v.flag() != nullptr) {
            log = *v.flag();
        } else {
            throw bad_parameter(
                key,
                fmt::format("a sweep has the numbers from, to and steps (whole) and log = true or false, not this \"{}\"", name));
        }
    }
    if (!std::isfinite(from) || !std::isfinite(to) || steps < 2 || steps > static_cast<std::int64_t>(most_points))
        throw bad_parameter(key, fmt::format("a sweep needs from, to and 2 to {} steps", most_points));
    if (log && !(from > 0.0 && to > 0.0)) throw bad_parameter(key, "a logarithmic sweep needs positive ends");
    std::vector<Value> out;
    for (std::int64_t i = 0; i < steps; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(steps - 1);
        const double x = log ? from * std::pow(to / from, part) : from + (to - from) * part;
        out.push_back({i + 1 == steps ? to : std::strtod(fmt::format("{:.12g}", x).c_str(), nullptr)});  // 1, not 0.99...
    }
    return out;
}

Variation variation_of(const std::string& key, const Value& v) {
    const std::vector<std::string> known = scenario_table().keys();
    const Option<S>* option = scenario_table().find(key);
    if (option == nullptr)
        throw input_error(fmt::format("unknown key \"{}\"", key), {},
                          fmt::format("did you mean \"{}\"?", nearest_key(key, known)));
    if (key == "seed" || key.starts_with("montecarlo.")) throw bad_parameter(key, "cannot vary: every run has a seed of its own");
    if (v.table() == nullptr || v.table()->size() != 1) throw bad_parameter(key, "has no distribution, or more than one");
    const auto& [name, numbers] = v.table()->front();
    const ValueList* list = numbers.list();
    Variation out;
    out.key = key;
    if (name == "list" || name == "sweep") {
        out.kind = name == "list" ? Variation::Kind::List : Variation::Kind::Sweep;
        if (name == "sweep" && numbers.table() != nullptr) {
            out.values = steps_of(key, *numbers.table());
        } else if (list != nullptr && !list->empty()) {
            out.values = *list;
        } else {
            throw bad_parameter(key, fmt::format("{} needs a list of values", name));
        }
        for (Value& value : out.values) {
            if (option->spec.shape == Shape::Integer && value.is_number())
                value.data = static_cast<std::int64_t>(std::llround(value.number()));
            try {
                check_value(option->spec, value, {});
            } catch (const Error& e) {
                throw input_error(fmt::format("{}: {}", key, e.reason()), {}, e.hint());
            }
        }
        return out;
    }
    if (name != "uniform" && name != "normal") throw bad_parameter(key, fmt::format("unknown distribution \"{}\"", name));
    if (option->spec.shape != Shape::Number && option->spec.shape != Shape::Integer)
        throw bad_parameter(key, "is not a key of one number: only list and sweep can vary it");
    if (list == nullptr || list->size() != 2 || !(*list)[0].is_number() || !(*list)[1].is_number())
        throw bad_parameter(key, "needs two numbers");
    out.kind = name == "normal" ? Variation::Kind::Normal : Variation::Kind::Uniform;
    out.first = (*list)[0].number();
    out.second = (*list)[1].number();
    out.whole = option->spec.shape == Shape::Integer;
    if (name == "normal" ? !(out.second >= 0.0) : !(out.second >= out.first))
        throw bad_parameter(key, "the two numbers are in the wrong order or negative");
    return out;
}

}  // namespace

std::size_t grid_points(const std::vector<Variation>& vary) {
    std::size_t points = 1;
    for (const Variation& v : vary) {
        if (v.kind != Variation::Kind::Sweep) continue;
        if (points > most_points / v.values.size())
            throw bad_parameter(v.key, fmt::format("the sweeps together have more than {} points", most_points));
        points *= v.values.size();
    }
    return points;
}

void add_montecarlo_options(OptionTable<ScenarioConfig>& table) {
    table.add(
        integer<S>("montecarlo.runs", 1, 100'000'000, "number of runs", [](auto& s) -> auto& { return s.montecarlo_runs; }));
    OptionSpec spec = detail::spec(
        "montecarlo.vary", Shape::Table,
        "settings that differ from run to run, any key of a scenario: \"KEY\" = { uniform = [low, high] }, { normal = [mean, sigma] }, "
        "{ list = [values] } (one of them at random) or { sweep = [values] }, { sweep = { from = 0, to = 10, steps = 11, log = false } } "
        "(all points of the grid of sweeps in turn)");
    table.add(Option<S>{std::move(spec),
                        [](S& s, const Value& v) {
                            s.vary.clear();
                            for (const auto& [key, distribution] : *v.table()) s.vary.push_back(variation_of(key, distribution));
                            (void)grid_points(s.vary);
                        },
                        [](const S&) { return std::optional<Value>(); }});
}

}  // namespace schuler::settings
