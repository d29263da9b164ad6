// What every fuzz target does: the first byte chooses the reader, the rest is its input, an Error is an answer like a result.
#pragma once

#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/io/text/text_input.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace schuler::fuzz {

/// Calls `read(choice, input, log)`. Anything but an Error that it throws ends the program.
template <class Read>
int run(const std::uint8_t* data, std::size_t size, Read read) {
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    WarningLog log;
    try {
        read(unsigned{data[0]}, io::TextInput::memory(bytes, "input"), log);
    } catch (const Error&) {}
    return 0;
}

}  // namespace schuler::fuzz
