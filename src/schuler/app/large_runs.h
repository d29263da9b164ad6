// Estimated cost of a large request, reported before it starts.
#pragma once

#include "schuler/settings/value.h"

#include <string>

namespace schuler::app {

/// One line on the time and memory required to simulate the scenario of a request, empty if they are small or the request has no
/// readable scenario. Estimated from the samples of all instruments.
[[nodiscard]] std::string notice_of_size(const settings::SettingList& given);

}  // namespace schuler::app
