// How the simulator refuses its settings.
#pragma once

#include "schuler/core/error.h"

#include <string>
#include <utility>

namespace schuler::sim::detail {

/// Throws Error(Input) naming the key of the scenario file, what is wrong with its value and a hint how to correct it.
inline void require(bool ok, std::string key, const char* what, const char* hint) {
    if (!ok) throw input_error(what, {.file = {}, .line = 0, .column = 0, .key = std::move(key)}, hint);
}

}  // namespace schuler::sim::detail
