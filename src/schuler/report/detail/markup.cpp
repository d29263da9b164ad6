#include "schuler/report/detail/markup.h"

#include "schuler/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::report {

namespace detail {

std::string anchor(std::string_view title, int number) {
    std::string id;
    for (const char c : title) {
        const bool upper = c >= 'A' && c <= 'Z';
        if (upper || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
            id += upper ? static_cast<char>(c - 'A' + 'a') : c;
        } else if (!id.empty() && id.back() != '-') {
            id += '-';
        }
    }
    while (!id.empty() && id.back() == '-') id.pop_back();
    return fmt::format("s{}{}{}", number, id.empty() ? "" : "-", id);
}

bool numeric_column(const TableBlock& table, std::size_t column) {
    const auto like_number = [column](const std::vector<std::string>& row) {
        if (column >= row.size() || row[column].empty() || row[column] == "-" || row[column] == "–") return true;
        const std::string& cell = row[column];
        const std::size_t sign = cell.front() == '-' || cell.front() == '+' ? 1 : 0;
        return cell.size() > sign && cell[sign] >= '0' && cell[sign] <= '9';
    };
    return !table.rows.empty() && std::ranges::all_of(table.rows, like_number);
}

}  // namespace detail

std::string number(double v, int significant) {
    if (!std::isfinite(v)) return "–";
    if (v == 0.0) return "0";
    // Rounded to the digits first, so that 9.9996 with four digits is 10.00 and not 10.000.
    const std::string scientific = fmt::format("{:.{}e}", v, std::max(significant, 1) - 1);
    const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
    if (exponent < -4 || exponent > 6) return scientific;
    return fmt::format("{:.{}f}", v, std::max(0, significant - 1 - exponent));
}

}  // namespace schuler::report
