// Positions of the receiver after an interruption that a smoothed run refutes.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/filter/update/timeline.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace schuler::fusion {

/// After an interruption the first fixes determine the position, right or wrong: some receivers are metres off for seconds when they
/// find their signals again. When their positions jump and the filter follows, the smoothed trajectory has the same jump a little
/// later, which no vehicle makes: what was used before it was wrong, and a smoother must not use it.
struct RefutedBeginning {
    Time first, end;                                 ///< stamps of the first wrong fix and of the first one after the jump
    Eigen::Vector3d jump = Eigen::Vector3d::Zero();  ///< of the trajectory, north, east, down, m
};

/// Jumps of a smoothed trajectory by more than a metre beyond its velocities (rows up to 0.2 s apart; of sparser rows up to 2 s apart
/// by more than 5 m) that the receiver made too (within half of the jump, and by more than four of its sigmas) after the last
/// interruption of 5 s and more or the beginning of the log.
[[nodiscard]] std::vector<RefutedBeginning> refuted_beginnings(const std::vector<SolutionRow>& smoothed,
                                                               const std::vector<GnssFix>& fixes, const earth::Earth& earth);

/// Withholds their positions. Returns how many.
std::size_t withhold(std::vector<filter::Event>& events, const std::vector<RefutedBeginning>& beginnings);

}  // namespace schuler::fusion
