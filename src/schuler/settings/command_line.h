// Between the words of a command line and the values of options.
#pragma once

#include "schuler/settings/option_table.h"

#include <string>
#include <vector>

namespace schuler::settings {

/// The words after an option as its value: numbers where it takes numbers and they are some, otherwise text for check_value to refuse.
[[nodiscard]] Value value_from_words(const OptionSpec& spec, const std::vector<std::string>& words);

/// The same back: {"--runs", "20"}; of an argument its value alone; nothing of a flag that is off. The value has passed check_value.
[[nodiscard]] std::vector<std::string> words_from_value(const OptionSpec& spec, const Value& value);

/// What help puts after the option: "T:DUR", "M_S", "NUMBER"; empty for a flag.
[[nodiscard]] std::string value_name_of(const OptionSpec& spec);

/// The sentence of help: what it is, and what holds where it is not given.
[[nodiscard]] std::string help_of(const OptionSpec& spec, const SettingList& defaults);

}  // namespace schuler::settings
