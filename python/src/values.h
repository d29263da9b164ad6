// Conversion between Python values and setting values.
#pragma once

#include "arrays.h"

#include "schuler/settings/option_table.h"

namespace schuler::python {

/// bool, int, float, str, a path, a list, tuple or array of these, a dict. @throws Error(Input) with `key` for anything else
[[nodiscard]] settings::Value value_from(const py::handle& object, const std::string& key);

/// The value of an option as expected by its command: a path as text, a list for comma-separated words, on and off for a flag.
[[nodiscard]] settings::Value value_for(const settings::OptionSpec& spec, const py::handle& object);

[[nodiscard]] py::object object_of(const settings::Value& value);

/// Settings of dataset.toml from a dict: keys with dots, or dicts in dicts. @throws Error(Input) for an unknown key, with the nearest one
[[nodiscard]] settings::SettingList settings_from(const py::dict& settings);

}  // namespace schuler::python
