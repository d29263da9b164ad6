// The option tables of the program as forms: data required by a page to draw fields, and conversion between a form and TOML.
#pragma once

#include "schuler/settings/option_table.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::serve {

using Json = nlohmann::ordered_json;

enum class Form { Scenario, Dataset };

/// [{key, shape, length, low, high, choices, accepts, help, unit, applies, default}], one entry per option.
[[nodiscard]] Json schema_of(const std::vector<settings::OptionSpec>& specs, const settings::SettingList& defaults);
/// For `schuler help scenario` or `schuler help settings`, in their order.
[[nodiscard]] Json form_schema(Form form);

/// Settings of a page, {key: value}, as settings of the program. @throws Refusal 422 for an unknown key or an invalid value
[[nodiscard]] settings::SettingList settings_from_json(const Json& object, Form form);
/// The same for any table, in the order of the object
[[nodiscard]] settings::SettingList settings_from_json(const Json& object, const std::vector<settings::OptionSpec>& specs);
/// @throws Error(Input) as for reading the file
[[nodiscard]] settings::SettingList settings_from_toml(const std::string& text, Form form);
[[nodiscard]] Json settings_json(const settings::SettingList& settings);
[[nodiscard]] std::string toml_of(const settings::SettingList& settings, Form form);

/// Effect of the settings: {settings, used, toml, problem, track?}. `problem` describes an error in them, with the key.
/// `used` has every option with its value after presets. A scenario includes its track.
[[nodiscard]] Json understood(const settings::SettingList& settings, Form form);

/// Copies the example files named by a scenario (a gravity field) into its folder.
void add_example_files(const settings::SettingList& settings, const std::filesystem::path& folder);

/// Command line words for the options given to a command by an order ({key: value}). @throws Refusal 422, Error
[[nodiscard]] std::vector<std::string> argument_words(const std::string& command_name, const Json& arguments);

}  // namespace schuler::serve
