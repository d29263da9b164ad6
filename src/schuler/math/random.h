// Seeded random numbers: independent streams by channel name, the same on every platform and standard library.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string_view>

namespace schuler::math {

/// xoshiro256++ (Blackman and Vigna 2021, ACM TOMS 47) seeded by splitmix64 from a seed and a channel name, so that a new
/// channel leaves the numbers of the others unchanged. The integers are identical on all platforms; the normal numbers come from
/// the polar method and differ at most by the last bit of std::log.
class Random {
public:
    Random(std::uint64_t seed, std::string_view channel);

    /// 64 uniform bits.
    [[nodiscard]] std::uint64_t bits();
    /// Uniform in [0, 1), all 53 bits.
    [[nodiscard]] double uniform();
    /// Standard normal.
    [[nodiscard]] double normal();
    /// Three independent standard normal numbers.
    [[nodiscard]] Eigen::Vector3d normal3();

private:
    std::array<std::uint64_t, 4> state_;
    double spare_ = 0.0;
    bool has_spare_ = false;
};

}  // namespace schuler::math
