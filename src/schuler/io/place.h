// Place of an error in a file, for messages.
#pragma once

#include "schuler/core/error.h"

#include <string>
#include <system_error>
#include <utility>

namespace schuler::io {

/// Line and column start at 1; 0 if not applicable.
[[nodiscard]] inline SourcePlace place_in(std::string file, long line = 0, long column = 0, std::string key = {}) {
    return {std::move(file), line, column, std::move(key)};
}

/// System message of an error number (errno).
[[nodiscard]] inline std::string system_message(int error_number) { return std::generic_category().message(error_number); }

}  // namespace schuler::io
