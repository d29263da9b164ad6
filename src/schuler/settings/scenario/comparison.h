// The comparison of a scenario: schemes, and evaluation windows.
#pragma once

#include "schuler/settings/value.h"

#include <string>
#include <vector>

namespace schuler::settings {

/// [[compare.window]], inclusive of both ends.
struct CompareWindow {
    std::string name;
    double start = 0.0, end = 0.0;  ///< s from the start of the scenario
};

/// Criteria for a valid solution.
struct WindowRules {
    double limit = 20.0;  ///< m, of the horizontal error; below it a solution is good
    double age = 1.5;     ///< s; an older solution is not used
    double hold = 5.0;    ///< s, required duration of a good solution for recovery
};

/// A scheme by its name in compare.schemes, with the settings that define it.
struct KnownScheme {
    const char* name;
    const char* title;
    SettingList settings;
};
[[nodiscard]] const std::vector<KnownScheme>& known_schemes();
/// The scheme of a given name.
[[nodiscard]] const KnownScheme& known_scheme(const std::string& name);

}  // namespace schuler::settings
