// The option tables of the program as forms: what a page needs to draw fields, and the way from a form to TOML and back.
#pragma once

#include "schuler/settings/option_table.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::serve {

using Json = nlohmann::ordered_json;

enum class Form { Scenario, Dataset };

/// [{key, shape, length, low, high, choices, accepts, help, unit, applies, default}], an entry of a table each.
[[nodiscard]] Json schema_of(const std::vector<settings::OptionSpec>& specs, const settings::SettingList& defaults);
/// Of `schuler help scenario` or `schuler help settings`, in their order.
[[nodiscard]] Json form_schema(Form form);

/// Settings of a page, {key: value}, as the program's. @throws Refusal 422 for an unknown key or a value of no use
[[nodiscard]] settings::SettingList settings_from_json(const Json& object, Form form);
/// Likewise of any table, in the order of the object
[[nodiscard]] settings::SettingList settings_from_json(const Json& object, const std::vector<settings::OptionSpec>& specs);
/// @throws Error(Input) as reading the file would
[[nodiscard]] settings::SettingList settings_from_toml(const std::string& text, Form form);
[[nodiscard]] Json settings_json(const settings::SettingList& settings);
[[nodiscard]] std::string toml_of(const settings::SettingList& settings, Form form);

/// What the settings come to: {settings, used, toml, problem, track?}. `problem` tells what makes them unusable, with the key.
/// `used` has every option with its value after presets. A scenario comes with its track.
[[nodiscard]] Json understood(const settings::SettingList& settings, Form form);

/// Puts the files of examples that a scenario names (a field of gravity) beside it.
void add_example_files(const settings::SettingList& settings, const std::filesystem::path& folder);

/// Words of the command line for the options that an order gives a command ({key: value}). @throws Refusal 422, Error
[[nodiscard]] std::vector<std::string> argument_words(const std::string& command_name, const Json& arguments);

}  // namespace schuler::serve
