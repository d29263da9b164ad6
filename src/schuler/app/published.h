// Numbers that somebody has published for a scenario, to stand beside those of a run.
#pragma once

#include "schuler/app/state_errors.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace schuler::app {

/// Root mean squares of the first five state blocks (position, velocity, attitude, gyro bias, accelerometer bias), SI; NaN: not told.
inline constexpr std::size_t published_blocks = 5;
using BlockRms = std::array<Eigen::Vector3d, published_blocks>;

struct Published {
    std::string source;          ///< empty: nothing is published
    BlockRms rms = [] {
        BlockRms none;
        none.fill(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
        return none;
    }();
};

/// Of the rows from `settled` on.
[[nodiscard]] BlockRms rms_of(const std::vector<StateErrors>& states, Time settled);

/// The table for people; empty where nothing is published. `heading`: what `ours` is.
[[nodiscard]] std::string published_table(const Published& published, const BlockRms& ours, const std::string& heading);

}  // namespace schuler::app
