// Rejection of invalid simulator settings.
#pragma once

#include "schuler/core/error.h"

#include <string>
#include <utility>

namespace schuler::sim::detail {

/// Throws Error(Input) with the key of the scenario file, the error of its value and a hint for its correction.
inline void require(bool ok, std::string key, const char* what, const char* hint) {
    if (!ok) throw input_error(what, {.file = {}, .line = 0, .column = 0, .key = std::move(key)}, hint);
}

}  // namespace schuler::sim::detail
