// The dictionary of column names: which words mean which canonical quantity. Private to columns.cpp.
#pragma once

#include "schuler/io/text/columns.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::io::detail {

enum class Dimension { Time, Angle, Length, Rate, Acceleration, Velocity, Pressure, Field, Temperature, Count };

/// A quantity and the stems (names without unit) that mean it. Stems separated by blanks; the first is the canonical one.
/// Stems before a '|' are clear, those behind it are guesses.
struct Quantity {
    std::string canonical;
    Dimension dimension;
    std::string stems;
    double sign = 1.0;
    HeightKind height = HeightKind::Unstated;
};

/// All quantities of a kind of table, in order of preference where several give the same canonical name.
[[nodiscard]] const std::vector<Quantity>& quantities(TableKind kind);

/// Names of the units of a dimension, the canonical one first.
[[nodiscard]] std::vector<std::string> unit_names(Dimension dimension);

/// The unit of a dimension with this name (words joined by '_'); nullopt where it is none.
[[nodiscard]] std::optional<UnitFactor> unit_factor(Dimension dimension, std::string_view unit);
[[nodiscard]] std::optional<TimeUnit> time_unit(std::string_view unit);

/// Words in front of a name that say where the value comes from but not what it is ("imu", "onboard", ...).
[[nodiscard]] bool is_origin_word(std::string_view word);

}  // namespace schuler::io::detail
