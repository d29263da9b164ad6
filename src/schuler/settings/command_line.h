// Conversion between words of a command line and option values.
#pragma once

#include "schuler/settings/option_table.h"

#include <string>
#include <vector>

namespace schuler::settings {

/// The words after an option as its value: numbers if it takes numbers and they are valid, otherwise text, which check_value rejects.
[[nodiscard]] Value value_from_words(const OptionSpec& spec, const std::vector<std::string>& words);

/// The inverse: {"--runs", "20"}; for an argument its value alone; empty for a flag that is off. The value has passed check_value.
[[nodiscard]] std::vector<std::string> words_from_value(const OptionSpec& spec, const Value& value);

/// Value name shown by the help after the option: "T:DUR", "M_S", "NUMBER"; empty for a flag.
[[nodiscard]] std::string value_name_of(const OptionSpec& spec);

/// Help text: description and default.
[[nodiscard]] std::string help_of(const OptionSpec& spec, const SettingList& defaults);

}  // namespace schuler::settings
