#include "schuler/math/random.h"

#include <bit>
#include <cmath>

namespace schuler::math {

namespace {

/// Advances a 64-bit counter and returns its scrambled value (Steele, Lea and Flood 2014).
std::uint64_t splitmix64(std::uint64_t& counter) {
    counter += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = counter;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

/// FNV-1a hash, because std::hash differs between libraries.
std::uint64_t fnv1a(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return hash;
}

}  // namespace

Random::Random(std::uint64_t seed, std::string_view channel) {
    // The seed is scrambled before it is combined with the name: seeds 1, 2, 3... and similar names must not give related states.
    std::uint64_t counter = seed;
    counter = splitmix64(counter) ^ fnv1a(channel);
    for (std::uint64_t& word : state_) word = splitmix64(counter);
}

std::uint64_t Random::bits() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
}

double Random::uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

double Random::normal() {
    if (has_spare_) {
        has_spare_ = false;
        return spare_;
    }
    // Marsaglia's polar method: a point uniform in the unit disc gives two independent normal numbers.
    double x, y, r2;
    do {
        x = 2.0 * uniform() - 1.0;
        y = 2.0 * uniform() - 1.0;
        r2 = x * x + y * y;
    } while (r2 >= 1.0 || r2 == 0.0);
    const double factor = std::sqrt(-2.0 * std::log(r2) / r2);
    spare_ = factor * y;
    has_spare_ = true;
    return factor * x;
}

Eigen::Vector3d Random::normal3() {
    const double x = normal(), y = normal(), z = normal();  // in this order with every compiler
    return {x, y, z};
}

}  // namespace schuler::math
