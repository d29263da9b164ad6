// Splitting of text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace schuler::io {

/// The parts between the separators, including empty ones; one part if there is no separator.
template <class Part = std::string>
[[nodiscard]] std::vector<Part> split(std::string_view text, char mark) {
    std::vector<Part> parts;
    while (true) {
        const std::size_t end = text.find(mark);
        parts.emplace_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

}  // namespace schuler::io
