// Whether a last line without a line end was cut within its last number. Private to the readers.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>
#include <string_view>

namespace schuler::io::detail {

/// How the last number of a line is written.
struct LastNumber {
    std::size_t decimals = 0;         ///< digits after the decimal point; all of them if there is no point
    std::size_t exponent_digits = 0;  ///< 0: written without an exponent
    bool open = false;                ///< ends where no number ends: "1.5e" or "1.5e-"
};

/// Blanks behind the number are not part of it: some programs end every row with one.
[[nodiscard]] inline LastNumber last_number(std::string_view line) {
    LastNumber n;
    const std::size_t end = line.find_last_not_of(" \t\r\n");
    line = line.substr(0, end == std::string_view::npos ? 0 : end + 1);
    const std::size_t start = line.find_last_not_of("0123456789.eE+-");
    if (start != std::string_view::npos) line.remove_prefix(start + 1);
    if (const std::size_t e = line.find_last_of("eE"); e != std::string_view::npos) {
        const std::string_view exponent = line.substr(std::min(line.find_first_not_of("+-", e + 1), line.size()));
        n.exponent_digits = exponent.size();
        n.open = exponent.empty();
        line = line.substr(0, e);
    }
    const std::size_t point = line.rfind('.');
    n.decimals =
        point != std::string_view::npos
            ? line.size() - point - 1
            : static_cast<std::size_t>(std::ranges::count_if(line, [](unsigned char c) { return std::isdigit(c) != 0; }));
    return n;
}

/// True if a last number without a line end may be the beginning of one that is written as that of the row above.
[[nodiscard]] inline bool may_be_cut(const LastNumber& above, const LastNumber& last) {
    if (last.open) return true;
    if (above.exponent_digits > 0) return last.exponent_digits < std::min<std::size_t>(above.exponent_digits, 2);
    return last.exponent_digits == 0 && last.decimals < above.decimals;
}

[[nodiscard]] inline std::string cut_text(long line) {
    return fmt::format("line {} has no line end and its last number is shorter than those above: left out", line);
}

}  // namespace schuler::io::detail
