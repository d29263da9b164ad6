// A sum that is independent of the order of its terms.
#pragma once

#include <array>
#include <cstdint>

namespace schuler::math {

/// Adds numbers in fixed point: 256 bits with the unit 2^-128. Terms are added without rounding (bits below the unit are truncated), so that
/// sums of partial sums, in any order and grouping, are bitwise equal. A term or a sum of 2^120 or more makes the sum infinite.
class ExactSum {
public:
    /// x must be finite.
    void add(double x);
    void add(const ExactSum& other);
    [[nodiscard]] double value() const;

    /// Limbs from the lowest, two's complement, and an overflow flag: the stored representation.
    std::array<std::uint64_t, 4> limbs{};
    bool overflow = false;

    [[nodiscard]] bool operator==(const ExactSum&) const = default;
};

}  // namespace schuler::math
