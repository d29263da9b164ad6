#include "schuler/report/result_table.h"

#include "schuler/io/text/csv/csv_field.h"
#include "schuler/report/detail/markup.h"
#include "schuler/report/inner/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace schuler::report {
namespace {

template <class... Ts>
struct ByType : Ts... {
    using Ts::operator()...;
};
template <class... Ts>
ByType(Ts...) -> ByType<Ts...>;  // not deduced by Clang 16

/// Formatted by fmt, with a % at the end in percent.
std::string formatted(double x, std::string_view format) {
    const bool percent = format.ends_with('%');
    if (percent) format.remove_suffix(1);
    return fmt::format(fmt::runtime(fmt::format("{{:{}}}{}", format, percent ? " %" : "")), percent ? 100.0 * x : x);
}

std::string shown(const Cell& cell, std::string_view format) {
    return std::visit(ByType{[](std::monostate) { return std::string("-"); },
                             [&](double x) { return format.empty() ? table_cell(x) : formatted(x == 0.0 ? 0.0 : x, format); },
                             [](std::int64_t x) { return fmt::format("{}", x); },
                             [](bool x) { return std::string(x ? "yes" : "no"); }, [](const std::string& text) { return text; }},
                      cell.value());
}

std::string filed(const Cell& cell, std::string_view format) {
    return std::visit(
        ByType{[](std::monostate) { return std::string(); }, [&](double x) { return formatted(x, format); },
               [](std::int64_t x) { return fmt::format("{}", x); }, [](bool x) { return std::string(x ? "1" : "0"); },
               [](const std::string& text) { return io::csv_field(text); }},
        cell.value());
}

Json json_of(const Cell& cell) {
    return std::visit(ByType{[](std::monostate) { return Json(nullptr); }, [](const auto& x) { return Json(x); }}, cell.value());
}

const Cell& cell_of(const std::vector<Cell>& row, std::size_t column) {
    static const Cell none;
    return column < row.size() ? row[column] : none;
}

/// Number of UTF-8 characters.
std::size_t width_of(std::string_view text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace

Cell::Cell(double x) {
    if (std::isfinite(x)) value_ = x;
}

ResultTable table_for_people(std::string title, std::initializer_list<std::string_view> headings) {
    ResultTable out{std::move(title)};
    for (const std::string_view heading : headings) out.columns.push_back({"", std::string(heading)});
    return out;
}

std::string table_cell(double x) { return std::isfinite(x) ? number(x) : "-"; }

TableBlock table_block(const ResultTable& table) {
    TableBlock block{table.title, {}, {}};
    block.rows.resize(table.rows.size());
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const TableColumn& column = table.columns[i];
        if (column.heading.empty()) continue;
        block.columns.push_back(column.heading + (column.unit.empty() ? "" : ", " + column.unit));
        for (std::size_t r = 0; r < table.rows.size(); ++r)
            block.rows[r].push_back(shown(cell_of(table.rows[r], i), column.format));
    }
    return block;
}

std::string table_text(const ResultTable& table) {
    constexpr std::size_t least_name = 24, least = 9;
    const TableBlock block = table_block(table);
    std::vector<std::string> lines(1 + block.rows.size());
    for (std::size_t i = 0; i < block.columns.size(); ++i) {
        const bool right = detail::numeric_column(block, i);
        std::size_t width = std::max(width_of(block.columns[i]), i == 0 && !right ? least_name : least);
        for (const auto& row : block.rows) width = std::max(width, width_of(row[i]));
        for (std::size_t r = 0; r < lines.size(); ++r) {
            const std::string& text = r == 0 ? block.columns[i] : block.rows[r - 1][i];
            const std::string pad(width - width_of(text), ' ');
            const bool heads = i == 0 && r == 0 && !right;  // a heading row; the others are indented
            lines[r] += (heads ? "" : "  ") + (right ? pad + text : text + pad) + (heads ? "  " : "");
        }
    }
    std::string out = table.title.empty() ? "" : table.title + "\n";
    for (std::string& line : lines) {
        line.erase(line.find_last_not_of(' ') + 1);
        out += line + "\n";
    }
    return out;
}

std::string table_csv(const ResultTable& table) {
    std::string out;
    const auto line = [&](auto text_of) {
        bool first = true;
        for (std::size_t i = 0; i < table.columns.size(); ++i) {
            if (table.columns[i].key.empty()) continue;
            out += (first ? "" : ",") + text_of(i);
            first = false;
        }
        out += '\n';
    };
    line([&](std::size_t i) { return io::csv_field(table.columns[i].key); });
    for (const auto& row : table.rows) line([&](std::size_t i) { return filed(cell_of(row, i), table.columns[i].file_format); });
    return out;
}

void put_row(Json& object, std::span<const TableColumn> columns, const std::vector<Cell>& row) {
    for (std::size_t i = 0; i < columns.size(); ++i)
        if (!columns[i].key.empty()) object[Json::json_pointer("/" + columns[i].key)] = json_of(cell_of(row, i));
}

Json table_json(const ResultTable& table) {
    Json out = Json::array();
    for (const auto& row : table.rows) put_row(out.emplace_back(Json::object()), table.columns, row);
    return out;
}

}  // namespace schuler::report
