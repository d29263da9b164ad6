#include "schuler/io/text/open_dates.h"

#include "schuler/io/text/detail/calendar_text.h"

#include <fmt/format.h>

namespace schuler::io {

std::string readings_of_open_date(const TableLayout& layout, int column) {
    for (std::size_t i = 0; i < layout.sample.size(); ++i) {
        const std::vector<std::string>& row = layout.sample[i];
        const auto at = static_cast<std::size_t>(column);
        if (column < 0 || at >= row.size()) continue;
        const auto date = detail::open_date(trimmed(row[at]));
        if (!date) continue;
        return fmt::format(
            "the order of day and month does not show: \"{}\" in line {} is {}-{:02}-{:02} (day first) or "
            "{}-{:02}-{:02} (month first)",
            row[at], layout.first_data_line + static_cast<long>(i), date->year, date->second, date->first, date->year,
            date->first, date->second);
    }
    return {};
}

}  // namespace schuler::io
