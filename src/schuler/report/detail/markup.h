// Parts of a page that are made of text.
#pragma once

#include "schuler/io/text/xml_text.h"
#include "schuler/report/report.h"

#include <string>
#include <string_view>

namespace schuler::report::detail {

/// An identifier of a-z, 0-9 and hyphens made from a title; number keeps it unique.
[[nodiscard]] std::string anchor(std::string_view title, int number);

/// Whether all cells of a column start like numbers, or are empty.
[[nodiscard]] bool numeric_column(const TableBlock& table, std::size_t column);

}  // namespace schuler::report::detail
