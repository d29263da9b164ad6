// A sum that does not depend on the order of its terms.
#pragma once

#include <array>
#include <cstdint>

namespace schuler::math {

/// Adds numbers in fixed point: 256 bits with the unit 2^-128. Every term is taken without rounding (what is below the unit is cut off), so that
/// sums of parts, added in any order and grouping, are equal bit for bit. A term or a sum of 2^120 or more makes the sum infinite.
class ExactSum {
public:
    /// x must be finite.
    void add(double x);
    void add(const ExactSum& other);
    [[nodiscard]] double value() const;

    /// Limbs from the lowest, two's complement, and whether it has left its range: what is stored of it.
    std::array<std::uint64_t, 4> limbs{};
    bool overflow = false;

    [[nodiscard]] bool operator==(const ExactSum&) const = default;
};

}  // namespace schuler::math
