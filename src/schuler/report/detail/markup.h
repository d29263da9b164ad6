// Text parts of a page.
#pragma once

#include "schuler/io/text/xml_text.h"
#include "schuler/report/report.h"

#include <string>
#include <string_view>

namespace schuler::report::detail {

/// An identifier of a-z, 0-9 and hyphens formed from a title; number makes it unique.
[[nodiscard]] std::string anchor(std::string_view title, int number);

/// True if all cells of a column start like numbers, or are empty.
[[nodiscard]] bool numeric_column(const TableBlock& table, std::size_t column);

}  // namespace schuler::report::detail
