// Conversion between facts of a data set and settings: found facts become settings, given settings restrict the search for the rest.
#pragma once

#include "schuler/core/fact.h"
#include "schuler/inspect/given.h"
#include "schuler/settings/config/config.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::settings {

[[nodiscard]] Value value_of(const FactValue& value);
/// Dates and nested lists cannot be represented in a fact and become text.
[[nodiscard]] FactValue fact_value_of(const Value& value);

/// Facts as the lowest layer of settings; `origin` is used in messages. Tables are completed by the given entries.
[[nodiscard]] SettingList settings_of(const std::vector<Fact>& facts, const std::string& origin);

/// Layers of settings where a later table of columns, scales or codes adds to an earlier one instead of replacing it.
[[nodiscard]] SettingList completed(SettingList found, SettingList given);

/// The statements of `given`, whose values are in `config`, about the files of a data set in `folder`.
[[nodiscard]] inspect::Given given_of(const Config& config, const SettingList& given, const std::filesystem::path& folder);

}  // namespace schuler::settings
