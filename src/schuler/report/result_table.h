// A table of results, defined once and printed as text, CSV, JSON (report/inner/json.h) and HTML.
#pragma once

#include "schuler/report/report.h"

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace schuler::report {

/// A value of a table: a number, an integer, yes or no, a text, or empty. A number that is not finite is
/// missing.
class Cell {
public:
    using Value = std::variant<std::monostate, double, std::int64_t, bool, std::string>;

    Cell() = default;
    Cell(double x);
    Cell(std::integral auto x) : value_(static_cast<std::int64_t>(x)) {}
    Cell(bool x) : value_(x) {}
    Cell(std::string text) : value_(std::move(text)) {}
    Cell(std::string_view text) : value_(std::string(text)) {}
    Cell(const char* text) : value_(std::string(text)) {}

    [[nodiscard]] const Value& value() const { return value_; }
    [[nodiscard]] bool missing() const { return std::holds_alternative<std::monostate>(value_); }

private:
    Value value_;
};

/// A column. Without a heading it is for files only, without a key for display only.
struct TableColumn {
    std::string key;                  ///< of CSV and JSON; in JSON "a/b" is b of an object a
    std::string heading;              ///< displayed heading
    std::string unit = {};            ///< of the heading: "m/s"
    const char* format = "";          ///< displayed number format of fmt: ".1f", with % as percent; "": four digits
    const char* file_format = ".9g";  ///< format in CSV
};

struct ResultTable {
    std::string title;  ///< above the table; may be empty
    std::vector<TableColumn> columns{};
    std::vector<std::vector<Cell>> rows{};  ///< one cell per column; additional ones are ignored, missing ones are empty
};

/// A table for display only.
[[nodiscard]] ResultTable table_for_people(std::string title, std::initializer_list<std::string_view> headings);

/// A column with the function that extracts it from an item.
template <class Item>
struct ColumnOf {
    TableColumn column;
    Cell (*of)(const Item&);
};

/// One row per item.
template <class Item>
ResultTable table_of(std::string title, std::span<const ColumnOf<Item>> columns, const std::vector<Item>& items) {
    ResultTable out{std::move(title)};
    for (const ColumnOf<Item>& c : columns) out.columns.push_back(c.column);
    for (const Item& item : items) {
        std::vector<Cell>& row = out.rows.emplace_back();
        for (const ColumnOf<Item>& c : columns) row.push_back(c.of(item));
    }
    return out;
}

/// A displayed number, with four digits; "-" if not finite.
[[nodiscard]] std::string table_cell(double x);

/// For a terminal: columns as wide as required, numbers right-aligned.
[[nodiscard]] std::string table_text(const ResultTable& table);
/// A header of the keys, empty fields for missing values.
[[nodiscard]] std::string table_csv(const ResultTable& table);
[[nodiscard]] TableBlock table_block(const ResultTable& table);

}  // namespace schuler::report
