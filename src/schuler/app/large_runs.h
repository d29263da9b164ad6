// What a request would take, where that is much: said before it begins.
#pragma once

#include "schuler/settings/value.h"

#include <string>

namespace schuler::app {

/// One line on the time and memory that simulating the scenario of a request takes, empty where it is little or the request has no
/// scenario that can be read. Estimates, by the samples of all instruments.
[[nodiscard]] std::string notice_of_size(const settings::SettingList& given);

}  // namespace schuler::app
