// The dictionary of column names: words and their canonical quantities. Private to columns.cpp.
#pragma once

#include "schuler/io/text/columns.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::io::detail {

/// A Calendar is a time that is written as a date with the time of day, never as a number.
enum class Dimension { Time, Calendar, Angle, Length, Rate, Acceleration, Velocity, Pressure, Field, Temperature, Count };

/// A quantity and its stems (names without unit). Stems are separated by blanks; the first is the canonical one. Stems before a
/// '|' are unambiguous, those after it are guesses.
struct Quantity {
    std::string canonical;
    Dimension dimension;
    std::string stems;
    double sign = 1.0;  ///< or the unit that the name implies
    HeightKind height = HeightKind::Unstated;
};

/// All quantities of a kind of table, in order of preference if several give the same canonical name.
[[nodiscard]] const std::vector<Quantity>& quantities(TableKind kind);

/// Names of the units of a dimension, the canonical one first.
[[nodiscard]] std::vector<std::string> unit_names(Dimension dimension);

/// The unit of a dimension with this name (words joined by '_'); nullopt if there is none.
[[nodiscard]] std::optional<UnitFactor> unit_factor(Dimension dimension, std::string_view unit);
[[nodiscard]] std::optional<TimeUnit> time_unit(std::string_view unit);

/// Leading words of a name that state the origin of a value but not its meaning ("imu", "onboard", ...).
[[nodiscard]] bool is_origin_word(std::string_view word);

}  // namespace schuler::io::detail
