// Columns that complete the value of another: the hemisphere beside a coordinate, the fraction beside whole seconds.
#pragma once

#include "schuler/io/text/columns.h"

#include <string_view>

namespace schuler::io::detail {

/// True if the column holds the fraction of a second that belongs to another column, as nsecs to secs.
[[nodiscard]] bool is_fraction_of_seconds(const TableLayout& layout, int column);

/// True if the first cells of the column are dates with the time of day.
[[nodiscard]] bool holds_dates(const TableLayout& layout, int column);

/// Fraction of the first rows with the number of the row before in this column; 0 if another column completes it.
[[nodiscard]] double repeated_share(const TableLayout& layout, int column);

/// Sets the companions of the matches, and removes other matches with these columns that the user has not given. Throws
/// Error(Input) if a column is named as the hemisphere of a coordinate but has other text.
void find_companions(ColumnPlan& plan, const TableLayout& layout);

/// 1 for north and east, -1 for south and west, 0 for any other text.
[[nodiscard]] int hemisphere_sign(std::string_view text);

/// An angle with or without its hemisphere ("40.09N", "W 105.1", "105.1 deg W" with the sign of degrees); NaN for any other text.
[[nodiscard]] double angle_with_hemisphere(std::string_view text);

}  // namespace schuler::io::detail
