// Under which settings an option has an effect: the one statement of it, for help, forms and documents, for the settings without effect of a
// run (solution/ignored.h) and of live navigation. What depends on the data is decided where the data are known.
#pragma once

#include <string_view>

namespace schuler::settings {

struct Config;

/// Applicability of the options whose keys begin with `prefix`.
struct Applicability {
    std::string_view prefix;
    std::string_view condition;                         ///< for help: "filter.scheme = \"separate\""; empty: always
    std::string_view (*idle)(const Config&) = nullptr;  ///< why they have no effect; empty: they may have; null: the data decide
};

/// The first match, in the order of the table; null: always applicable.
[[nodiscard]] const Applicability* applicability_of(std::string_view key);

/// Why the option has no effect under the other settings alone; empty: it may have one.
[[nodiscard]] std::string_view idle_reason(std::string_view key, const Config& config);

}  // namespace schuler::settings
