#include "schuler/math/exact_sum.h"

#include <bit>
#include <cmath>
#include <limits>

namespace schuler::math {
namespace {

constexpr int unit_exponent = -128, largest_exponent = 120;

/// Adds `part` at a limb with carry.
void add_at(std::array<std::uint64_t, 4>& limbs, std::size_t i, std::uint64_t part) {
    for (; part != 0 && i < limbs.size(); ++i) {
        limbs[i] += part;
        part = limbs[i] < part ? 1 : 0;
    }
}

void subtract_at(std::array<std::uint64_t, 4>& limbs, std::size_t i, std::uint64_t part) {
    for (; part != 0 && i < limbs.size(); ++i) {
        const std::uint64_t before = limbs[i];
        limbs[i] -= part;
        part = limbs[i] > before ? 1 : 0;
    }
}

bool negative(const std::array<std::uint64_t, 4>& limbs) { return (limbs[3] >> 63U) != 0; }

/// True if a sum near the end of its range could wrap with the next term.
bool leaves_range(const std::array<std::uint64_t, 4>& limbs) {
    const std::uint64_t top = negative(limbs) ? ~limbs[3] : limbs[3];
    return (top >> static_cast<unsigned>(largest_exponent - unit_exponent - 192)) != 0;
}

}  // namespace

void ExactSum::add(double x) {
    if (std::abs(x) >= std::ldexp(1.0, largest_exponent)) {
        overflow = true;
        return;
    }
    const auto bits = std::bit_cast<std::uint64_t>(std::abs(x));
    const int exponent = static_cast<int>(bits >> 52U);
    std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52U) - 1);
    if (exponent != 0) mantissa |= std::uint64_t{1} << 52U;
    const int shift = (exponent == 0 ? 1 : exponent) - 1075 - unit_exponent;
    if (shift <= -64) return;
    const auto place = [&](void (*at)(std::array<std::uint64_t, 4>&, std::size_t, std::uint64_t)) {
        if (shift < 0) return at(limbs, 0, mantissa >> static_cast<unsigned>(-shift));
        const auto limb = static_cast<std::size_t>(shift / 64);
        const auto bit = static_cast<unsigned>(shift % 64);
        at(limbs, limb, mantissa << bit);
        if (bit != 0) at(limbs, limb + 1, mantissa >> (64U - bit));
    };
    place(std::signbit(x) ? subtract_at : add_at);
    if (leaves_range(limbs)) overflow = true;
}

void ExactSum::add(const ExactSum& other) {
    overflow = overflow || other.overflow;
    for (std::size_t i = 0; i < limbs.size(); ++i) add_at(limbs, i, other.limbs[i]);
    if (leaves_range(limbs)) overflow = true;
}

double ExactSum::value() const {
    if (overflow) return std::numeric_limits<double>::infinity();
    std::array<std::uint64_t, 4> size = limbs;
    const bool minus = negative(limbs);
    if (minus) {
        for (std::uint64_t& limb : size) limb = ~limb;
        add_at(size, 0, 1);
    }
    double out = 0.0;
    for (std::size_t i = 0; i < size.size(); ++i)
        out += std::ldexp(static_cast<double>(size[i]), static_cast<int>(64 * i) + unit_exponent);
    return minus ? -out : out;
}

}  // namespace schuler::math
