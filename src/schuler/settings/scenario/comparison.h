// What a scenario compares: schemes, and windows in which they are judged.
#pragma once

#include "schuler/settings/value.h"

#include <string>
#include <vector>

namespace schuler::settings {

/// [[compare.window]], both ends belong to it.
struct CompareWindow {
    std::string name;
    double start = 0.0, end = 0.0;  ///< s from the start of the scenario
};

/// When a solution counts.
struct WindowRules {
    double limit = 20.0;  ///< m, of the horizontal error; below it a solution is good
    double age = 1.5;     ///< s; an older solution is none
    double hold = 5.0;    ///< s, so long it must be good to have recovered
};

/// A scheme by its name in compare.schemes: settings that make it.
struct KnownScheme {
    const char* name;
    const char* title;
    SettingList settings;
};
[[nodiscard]] const std::vector<KnownScheme>& known_schemes();
/// One of them by its name.
[[nodiscard]] const KnownScheme& known_scheme(const std::string& name);

}  // namespace schuler::settings
