// How the simulator refuses its settings.
#pragma once

#include "schuler/core/error.h"

#include <string>
#include <utility>

namespace schuler::sim::detail {

/// Throws Error(Input) naming the key of the scenario file, what is wrong with its value and the mend.
inline void require(bool ok, std::string key, const char* what, const char* mend) {
    if (!ok) throw input_error(what, {.file = {}, .line = 0, .column = 0, .key = std::move(key)}, mend);
}

}  // namespace schuler::sim::detail
