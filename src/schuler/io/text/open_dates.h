// Dates with the year last whose day and month do not show: 05/03/2024.
#pragma once

#include "schuler/io/text/table.h"

#include <string>

namespace schuler::io {

/// Both readings of the first such date of a column; empty if there is none.
[[nodiscard]] std::string readings_of_open_date(const TableLayout& layout, int column);

}  // namespace schuler::io
