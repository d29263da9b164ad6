// Lists in one text: the parts of a path, the columns of a table.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::serve {

/// The parts between the marks, empty ones too: one more than there are marks.
[[nodiscard]] inline std::vector<std::string> split(std::string_view text, char mark) {
    std::vector<std::string> out;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(mark, begin), text.size());
        out.emplace_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return out;
}

}  // namespace schuler::serve
