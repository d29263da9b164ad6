// Names of instruments as users write them.
#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace schuler::sensor::detail {

/// Lower case, without '-', '_' and blanks.
[[nodiscard]] inline std::string bare(std::string_view name) {
    std::string out;
    for (const char c : name)
        if (c != '-' && c != '_' && c != ' ') out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return out;
}

}  // namespace schuler::sensor::detail
