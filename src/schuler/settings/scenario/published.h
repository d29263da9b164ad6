// Published results for a scenario, for comparison with those of a run.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <limits>
#include <string>

namespace schuler::settings {

/// Root mean squares of the first five state blocks (position, velocity, attitude, gyro bias, accelerometer bias), SI; NaN: not stated.
inline constexpr std::size_t published_blocks = 5;
using BlockRms = std::array<Eigen::Vector3d, published_blocks>;

struct Published {
    std::string source;  ///< empty: none published
    BlockRms rms = [] {
        BlockRms none;
        none.fill(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
        return none;
    }();
};

}  // namespace schuler::settings
