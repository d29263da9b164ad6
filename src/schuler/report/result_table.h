// A table of results, declared once and printed as text, CSV, JSON and HTML.
#pragma once

#include "schuler/report/report.h"

#include <string>
#include <utility>
#include <vector>

namespace schuler::report {

/// A quantity of every row.
struct TableColumn {
    const char* key;    ///< of JSON and CSV
    const char* title;  ///< for people, with its unit
};

struct ResultRow {
    std::string name;     ///< for people
    std::string group{};  ///< for people: heads the rows that share it; empty: none
    std::vector<std::pair<std::string, std::string>>
        labels{};                   ///< of CSV, before the numbers: {"scheme", "loose"}; the first stands for the name
    std::vector<double> numbers{};  ///< one a column; further ones are left out, missing ones are NaN
};

struct ResultTable {
    std::string title;  ///< heads the names
    std::vector<TableColumn> columns{};
    std::vector<ResultRow> rows{};
};

/// Four significant digits, "-" where not finite.
[[nodiscard]] std::string table_cell(double x);

/// For a terminal, right-aligned under the titles.
[[nodiscard]] std::string table_text(const ResultTable& table);
/// With a header of the labels' names and the columns' keys; nine significant digits, empty where not finite.
[[nodiscard]] std::string table_csv(const ResultTable& table);
/// For a page: the name under the first label, the further labels, the numbers.
[[nodiscard]] TableBlock table_block(const ResultTable& table);

}  // namespace schuler::report
