#include "schuler/report/result_table.h"

#include "schuler/report/inner/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace schuler::report {
namespace {

double number_of(const ResultRow& row, std::size_t column) {
    return column < row.numbers.size() ? row.numbers[column] : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::string table_cell(double x) {
    if (!std::isfinite(x)) return "-";
    const double a = std::abs(x);
    return a != 0.0 && (a < 1e-3 || a >= 1e5) ? fmt::format("{:.2e}", x) : fmt::format("{:.4g}", x);
}

std::string table_text(const ResultTable& table) {
    // A column is as wide as its numbers need, or its title.
    const auto width = [](const TableColumn& column) {
        return std::max<std::size_t>(13, std::string_view(column.title).size() + 2);
    };
    std::size_t names = std::max<std::size_t>(34, table.title.size());
    for (const ResultRow& row : table.rows) names = std::max(names, row.name.size());
    std::string out = fmt::format("{:<{}}", table.title, names + 2), group;
    for (const TableColumn& column : table.columns) out += fmt::format("{:>{}}", column.title, width(column));
    out += "\n";
    for (const ResultRow& row : table.rows) {
        if (row.group != group) out += row.group + "\n";
        group = row.group;
        out += fmt::format("  {:<{}}", row.name, names);
        for (std::size_t i = 0; i < table.columns.size(); ++i)
            out += fmt::format("{:>{}}", table_cell(number_of(row, i)), width(table.columns[i]));
        out += "\n";
    }
    return out;
}

std::string table_csv(const ResultTable& table) {
    std::string out;
    const auto field = [&out](const std::string& text, bool first) { out += (first ? "" : ",") + text; };
    if (!table.rows.empty())
        for (const auto& [name, value] : table.rows.front().labels) field(name, out.empty());
    for (const TableColumn& column : table.columns) out += fmt::format(",{}", column.key);
    for (const ResultRow& row : table.rows) {
        out += "\n";
        for (std::size_t i = 0; i < row.labels.size(); ++i) field(row.labels[i].second, i == 0);
        for (std::size_t i = 0; i < table.columns.size(); ++i) {
            const double x = number_of(row, i);
            out += std::isfinite(x) ? fmt::format(",{:.9g}", x) : ",";
        }
    }
    return out + "\n";
}

TableBlock table_block(const ResultTable& table) {
    TableBlock block{table.title, {}, {}};
    if (!table.rows.empty())
        for (const auto& [name, value] : table.rows.front().labels) block.columns.push_back(name);
    for (const TableColumn& column : table.columns) block.columns.emplace_back(column.title);
    for (const ResultRow& row : table.rows) {
        std::vector<std::string>& cells = block.rows.emplace_back();
        cells.push_back(row.name);
        for (std::size_t i = 1; i < row.labels.size(); ++i) cells.push_back(row.labels[i].second);
        for (std::size_t i = 0; i < table.columns.size(); ++i) cells.push_back(number(number_of(row, i)));
    }
    return block;
}

void put_row(Json& object, const std::vector<TableColumn>& columns, const std::vector<double>& numbers) {
    for (std::size_t i = 0; i < columns.size() && i < numbers.size(); ++i) object[columns[i].key] = json_number(numbers[i]);
}

}  // namespace schuler::report
