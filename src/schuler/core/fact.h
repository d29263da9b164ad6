// What is known about a data set, and how it is known: the settings that a log states or shows by itself.
#pragma once

#include "schuler/core/samples.h"

#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace schuler {

/// How a setting is known: given by the user, stated by a data file, found from the data, or none of these.
enum class Known { Given, File, Found, Default };
[[nodiscard]] std::string_view name_of(Known how);  ///< "given", "file", "found", "default"

/// A value in the unit that its key names.
using FactValue = std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>,
                               std::map<std::string, std::string>, std::map<std::string, double>>;

struct Fact {
    std::string key;  ///< of dataset.toml: "gnss.latency_s"
    FactValue value;
    Known how = Known::Found;
    double sigma = not_given;  ///< one sigma in the unit of the key; NaN where there is none
    double from = not_given,
           to = not_given;  ///< s after the first GNSS epoch: the span that shows it; NaN where that means nothing
    std::string note;       ///< the evidence, for people
};

/// As TOML writes it: "frd", 0.12, [0, 0, 1], { height_m = "alt" }. Numbers in the fewest digits that read back the same.
[[nodiscard]] std::string to_text(const FactValue& value);

/// A TOML basic string of any text.
[[nodiscard]] std::string toml_text(std::string_view text);

}  // namespace schuler
