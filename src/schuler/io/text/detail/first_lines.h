// The beginning of a text, for recognition of its format.
#pragma once

#include "schuler/io/text/text_input.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

namespace schuler::io::detail {

/// At most 200 lines of the first block, without their ends; valid as long as `blocks` is not advanced.
[[nodiscard]] inline std::vector<std::string_view> first_lines(LineBlocks& blocks) {
    std::vector<std::string_view> lines;
    if (!blocks.next()) return lines;
    std::string_view text(blocks.begin(), static_cast<std::size_t>(blocks.end() - blocks.begin()));
    while (!text.empty() && lines.size() < 200) {
        lines.push_back(text.substr(0, text.find('\n')));
        text.remove_prefix(std::min(lines.back().size() + 1, text.size()));
    }
    return lines;
}

}  // namespace schuler::io::detail
