#include "serve/forms.h"

#include "schuler/core/units.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/toml_file.h"
#include "schuler/sim/path.h"
#include "serve/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::serve {
namespace {

using settings::Shape;
using settings::Value;

constexpr double longest_preview_s = 7200.0;
constexpr int preview_points = 800;

const std::vector<settings::OptionSpec>& specs_of(Form form) {
    return form == Form::Scenario ? settings::scenario_table().specs() : settings::config_table().specs();
}

const char* name_of(Shape shape) {
    switch (shape) {
        case Shape::Number: return "number";
        case Shape::Integer: return "integer";
        case Shape::Flag: return "flag";
        case Shape::Text: return "text";
        case Shape::Numbers: return "numbers";
        case Shape::Texts: return "texts";
        case Shape::Table: return "table";
        case Shape::Tables: return "tables";
        case Shape::Any: break;
    }
    return "any";
}

Json json_of(const Value& value) {
    if (const auto* b = value.flag()) return *b;
    if (const auto* i = value.integer()) return *i;
    if (value.is_number()) return std::isfinite(value.number()) ? Json(value.number()) : Json(nullptr);
    if (const auto* t = value.text()) return *t;
    if (const auto* list = value.list()) {
        Json out = Json::array();
        for (const Value& v : *list) out.push_back(json_of(v));
        return out;
    }
    Json out = Json::object();
    for (const auto& [name, v] : *value.table()) out[name] = json_of(v);
    return out;
}

Value value_of(const Json& json, const std::string& key, int depth = 0) {
    if (depth > 8) throw Refusal{422, "nested too deeply", {}, key};
    if (json.is_boolean()) return {json.get<bool>()};
    if (json.is_number_integer()) return {json.get<std::int64_t>()};
    if (json.is_number()) return {json.get<double>()};
    if (json.is_string()) return {json.get<std::string>()};
    if (json.is_array()) {
        settings::ValueList list;
        for (const Json& item : json) list.push_back(value_of(item, key, depth + 1));
        return {std::move(list)};
    }
    if (json.is_object()) {
        settings::ValueTable table;
        for (const auto& [name, item] : json.items()) table.emplace_back(name, value_of(item, key, depth + 1));
        return {std::move(table)};
    }
    throw Refusal{422, "has no value", "leave the key out", key};
}

/// So that equal settings give equal files.
settings::SettingList in_table_order(settings::SettingList settings, Form form) {
    const auto& specs = specs_of(form);
    std::ranges::stable_sort(settings, {}, [&](const settings::Setting& s) {
        return std::ranges::find(specs, s.key, &settings::OptionSpec::key) - specs.begin();
    });
    return settings;
}

settings::SettingList defaults_of(Form form) {
    return form == Form::Scenario ? settings::scenario_table().used(settings::ScenarioConfig{})
                                  : settings::config_table().used(settings::Config{});
}

/// Path of the vehicle with speed and attitude: degrees and metres for drawing.
Json track_of(const settings::ScenarioConfig& s, bool cut) {
    const auto path = sim::make_path(s.sim.path, s.sim.earth.ellipsoid);
    const Geodetic origin = path->at(0.0).position;
    std::array<Json, 9> columns;
    columns.fill(Json::array());
    for (int i = 0; i <= preview_points; ++i) {
        const double t = s.sim.duration * i / preview_points;
        const sim::Kinematics k = path->at(t);
        const Eigen::Vector3d ned = earth::ned_difference(s.sim.earth, k.position, origin);
        const std::array<double, 9> row{t,
                                        ned.x(),
                                        ned.y(),
                                        k.position.h,
                                        k.v_eb_n.norm(),
                                        k.rpy.x() / units::deg,
                                        k.rpy.y() / units::deg,
                                        k.rpy.z() / units::deg,
                                        -ned.z()};
        for (std::size_t c = 0; c < row.size(); ++c) columns[c].push_back(std::isfinite(row[c]) ? Json(row[c]) : Json(nullptr));
    }
    return {{"time_s", columns[0]},    {"north_m", columns[1]},
            {"east_m", columns[2]},    {"height_m", columns[3]},
            {"speed_m_s", columns[4]}, {"roll_deg", columns[5]},
            {"pitch_deg", columns[6]}, {"heading_deg", columns[7]},
            {"up_m", columns[8]},      {"cut", cut}};
}

Json problem_json(const Error& e) {
    return {{"text", e.reason()}, {"mend", e.hint()}, {"key", e.place().key}, {"line", e.place().line}};
}

/// Choices supported by this version: the table also lists planned ones, to distinguish them from misspelt ones.
std::vector<std::string> offered(const settings::OptionSpec& spec) {
    std::vector<std::string> out;
    for (const std::string& choice : spec.choices)
        if (spec.form.empty() || spec.form.find('"' + choice + '"') != std::string::npos) out.push_back(choice);
    return out;
}

}  // namespace

Json schema_of(const std::vector<settings::OptionSpec>& specs, const settings::SettingList& defaults) {
    Json out = Json::array();
    for (const settings::OptionSpec& s : specs) {
        const auto given = std::ranges::find(defaults, s.key, &settings::Setting::key);
        out.push_back({{"key", s.key},
                       {"shape", name_of(s.shape)},
                       {"length", s.length},
                       {"low", std::isfinite(s.low) ? Json(s.low) : Json(nullptr)},
                       {"high", std::isfinite(s.high) ? Json(s.high) : Json(nullptr)},
                       {"choices", offered(s)},
                       {"accepts", settings::accepted_form(s)},
                       {"help", s.help},
                       {"unit", s.unit},
                       {"applies", s.applies},
                       {"required", s.line.required},
                       {"default", given == defaults.end() ? Json(nullptr) : json_of(given->value)}});
    }
    return out;
}

Json form_schema(Form form) { return schema_of(specs_of(form), defaults_of(form)); }

settings::SettingList settings_from_json(const Json& object, const std::vector<settings::OptionSpec>& specs) {
    if (!object.is_object()) throw Refusal{422, "the settings are not an object", "send {\"settings\": {\"key\": value}}"};
    settings::SettingList out;
    for (const auto& [key, value] : object.items()) {
        const auto spec = std::ranges::find(specs, key, &settings::OptionSpec::key);
        if (spec == specs.end()) {
            std::vector<std::string> known;
            for (const auto& s : specs) known.push_back(s.key);
            const std::string near = settings::nearest_key(key, known);
            throw Refusal{422, "unknown key", near.empty() ? "" : fmt::format("did you mean {}?", near), key};
        }
        out.push_back({key, value_of(value, key), {"", 0, 0, key}});
    }
    return out;
}

settings::SettingList settings_from_json(const Json& object, Form form) {
    return in_table_order(settings_from_json(object, specs_of(form)), form);
}

settings::SettingList settings_from_toml(const std::string& text, Form form) {
    const settings::ValueTable root = settings::parse_toml(text, "");
    return in_table_order(
        form == Form::Scenario ? settings::scenario_table().read(root, "") : settings::config_table().read(root, ""), form);
}

Json settings_json(const settings::SettingList& settings) {
    Json out = Json::object();
    for (const settings::Setting& s : settings) out[s.key] = json_of(s.value);
    return out;
}

std::string toml_of(const settings::SettingList& settings, Form form) {
    return settings::to_toml(settings, specs_of(form), false);
}

Json understood(const settings::SettingList& settings, Form form) {
    Json out{
        {"settings", settings_json(settings)}, {"used", Json::object()}, {"toml", toml_of(settings, form)}, {"problem", nullptr}};
    // read relative to the scenario, that is, from anywhere: not permitted for a page
    if (form == Form::Scenario && std::ranges::find(settings, "trajectory.file", &settings::Setting::key) != settings.end()) {
        out["problem"] = {{"text", "a recording is not flown again from the page"},
                          {"mend", "leave it out, or use `schuler run` with the file"},
                          {"key", "trajectory.file"},
                          {"line", 0}};
        return out;
    }
    try {
        if (form == Form::Dataset) {
            settings::Config config;
            settings::config_table().apply(settings, config);
            out["used"] = settings_json(settings::config_table().used(config));
            return out;
        }
        settings::SettingList preview = settings;
        bool cut = false;
        for (settings::Setting& s : preview) {
            if (s.key != "duration_s" || !s.value.is_number() || s.value.number() <= longest_preview_s) continue;
            if (s.value.number() <= 1e6) s.value = {longest_preview_s}, cut = true;
        }
        const settings::ScenarioConfig config = settings::scenario_from(preview);
        Json used = settings_json(settings::scenario_table().used(config));
        for (const settings::Setting& s : settings)
            if (s.key == "duration_s") used["duration_s"] = json_of(s.value);
        out["used"] = std::move(used);
        out["track"] = track_of(config, cut);
    } catch (const Error& e) {
        out["problem"] = problem_json(e);
    }
    return out;
}

}  // namespace schuler::serve
