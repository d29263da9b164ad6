// Facts about a data set and their origin: settings that a log states or that follow from its data.
#pragma once

#include "schuler/core/samples.h"

#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace schuler {

/// Origin of a setting: given by the user, stated by a data file, found from the data, or none of these.
enum class Known { Given, File, Found, Default };
[[nodiscard]] std::string_view name_of(Known how);  ///< "given", "file", "found", "default"

/// A value in the unit implied by its key.
using FactValue = std::variant<bool, double, std::string, std::vector<double>, std::vector<std::string>,
                               std::map<std::string, std::string>, std::map<std::string, double>>;

struct Fact {
    std::string key;  ///< of dataset.toml: "gnss.latency_s"
    FactValue value;
    Known how = Known::Found;
    double sigma = not_given;  ///< one sigma in the unit of the key; NaN if there is none
    double from = not_given,
           to = not_given;  ///< s after the first GNSS epoch: the interval of the evidence; NaN if not applicable
    std::string note;       ///< the evidence, for display
};

/// In TOML syntax: "frd", 0.12, [0, 0, 1], { height_m = "alt" }. Numbers have the fewest digits that read back identically.
[[nodiscard]] std::string to_text(const FactValue& value);

/// Any text as a TOML basic string.
[[nodiscard]] std::string toml_text(std::string_view text);

}  // namespace schuler
