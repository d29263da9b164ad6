// Velocity columns compared with the displacement of the positions: unit, order and signs.
#pragma once

#include "schuler/core/samples.h"

#include <array>
#include <vector>

namespace schuler::inspect::detail {

/// Which column is which component, and with which sign: component i is sign[i] * column[from[i]].
struct VelocityOrder {
    std::array<int, 3> from{0, 1, 2};
    std::array<double, 3> sign{1.0, 1.0, 1.0};
    [[nodiscard]] bool operator==(const VelocityOrder&) const = default;
};

/// Comparison of the columns with the displacements. Misses are means over the intervals of the squared difference relative to the squared
/// displacement, at most 1 each.
struct VelocityColumns {
    int intervals = 0;          ///< of significant horizontal displacement; the rest is void if there are too few
    VelocityOrder order;        ///< the one nearest to the names of those that the data do not distinguish
    double factor = 1.0;        ///< displacement / integral of the columns in this order
    double factor_sigma = 0.0;  ///< by leaving out a tenth of the intervals at a time
    double miss = 1.0;          ///< in this order, times the factor
    double miss_as_named = 1.0;
    double gain_sigma = 0.0;  ///< one sigma of miss_as_named - miss

    int vertical_intervals = 0;
    double vertical_factor = not_given;  ///< height change / integral of the vertical column with its sign as named and times the
                                         ///< horizontal factor; NaN if height and column do not move together
    double vertical_sigma = 0.0;
};

/// The comparison allows for a velocity older than the position, which does not change the factors. Intervals are long enough for
/// the displacement to exceed the noise of the positions fifteen times, and without jumps; a vehicle that does not travel has none.
/// @param fixes in order of time; rad, m, m/s @param has_down there is a vertical column
[[nodiscard]] VelocityColumns velocity_columns(const std::vector<GnssFix>& fixes, bool has_down);

}  // namespace schuler::inspect::detail
