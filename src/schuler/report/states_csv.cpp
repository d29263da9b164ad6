#include "schuler/report/states_csv.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace schuler::report {
namespace {

/// m/s^2 as m_s2; nothing for pure numbers.
std::string unit_suffix(std::string_view unit) {
    if (unit == "1") return {};
    std::string out = "_";
    for (const char c : unit) {
        if (c == '/') out += '_';
        else if (c != '^') out += c;
    }
    return out;
}

}  // namespace

std::string states_csv(std::span<const filter::LayoutBlock> states, std::span<const filter::ParameterRow> rows) {
    std::string text = "time_s";
    for (const filter::LayoutBlock& block : states) {
        if (block.offset < filter::Layout::navigation) continue;
        for (int i = 1; i <= block.size; ++i) {
            const std::string number = block.size > 1 ? fmt::format("_{}", i) : std::string();
            const std::string name = fmt::format("{}{}{}", block.name, number, unit_suffix(block.unit));
            text += fmt::format(",{0},std_{0}", name);
        }
    }
    text += '\n';
    for (const filter::ParameterRow& row : rows) {
        text += fmt::format("{:.9f}", row.time.seconds());
        for (std::size_t i = 0; i < row.value.size(); ++i) {
            if (std::isnan(row.std[i])) text += ",,";  // of no satellite at this time
            else fmt::format_to(std::back_inserter(text), ",{:.9g},{:.6g}", row.value[i], row.std[i]);
        }
        text += '\n';
    }
    return text;
}

}  // namespace schuler::report
