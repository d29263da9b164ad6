// A simulated receiver whose tracking loops follow a solution that is made of its own fixes: loose coupling with aided loops.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"
#include "schuler/scenario/simulated_receiver.h"

#include <vector>

namespace schuler::solution {

/// Tracks again through a whole flight, with the loops (receiver::Guidance::Loops) aided at every row by the solution until then and by
/// the receiver's clock as its last ranges show it (paper A, 1.1: the MAGR scheme). `lever_arm_b`: of the antenna.
[[nodiscard]] RangingLog ranges_aided_by(const std::vector<SolutionRow>& rows, const earth::Earth& earth,
                                         const Eigen::Vector3d& lever_arm_b, scenario::SimulatedReceiver& receiver);

}  // namespace schuler::solution
